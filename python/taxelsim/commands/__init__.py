"""Subcommands of `taxelsim` that are written in Python."""
