"""`taxelsim inspect DIR --format oxt`: checks an Open-X-Tactile set by every rule of the contract, with the source of each."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

from ..errors import InputError
from ..export.oxt_rules import check, open_store
from .running import run_command


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    options = _parser().parse_args(arguments)
    return run_command("inspect", lambda: _run(options))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="taxelsim inspect", description=__doc__)
    parser.add_argument("folder", type=Path, metavar="DIR", help="Zarr folder")
    parser.add_argument("--format", required=True, choices=("oxt",), help="of the folder; without it a data set of taxelsim is inspected")
    parser.add_argument("--json", action="store_true", help="prints JSON")
    return parser


def _run(options: argparse.Namespace) -> None:
    store = open_store(options.folder)
    findings = check(store)
    broken = [faults[0] for rule, faults in findings if faults and not rule.is_note]
    if options.json:
        rules = [{"rule": rule.text, "source": rule.source, "note": rule.is_note, "faults": faults} for rule, faults in findings]
        print(json.dumps({"folder": str(options.folder), "passed": not broken, "rules": rules}, indent=2))
    else:
        rows = [(_verdict(rule.is_note, faults), rule.text, rule.source) for rule, faults in findings]
        widths = [max(len(row[column]) for row in rows) for column in (0, 1)]
        for row, (_, faults) in zip(rows, findings, strict=True):
            print(f"{row[0]:<{widths[0]}}  {row[1]:<{widths[1]}}  {row[2]}")
            for fault in faults:
                print(f"{'':<{widths[0]}}  - {fault}")
    if broken:
        raise InputError(f"{options.folder}: {broken[0]}{f'; {len(broken) - 1} more rules are broken' if len(broken) > 1 else ''}")


def _verdict(is_note: bool, faults: Sequence[str]) -> str:
    return "kept" if not faults else "note" if is_note else "broken"
