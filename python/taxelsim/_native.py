"""Signatures of the classes and functions of _core for inspect.signature(), and one line about arguments that they do not take.

_core calls describe() when it is imported as a part of the package. By itself nanobind answers wrong arguments with all signatures.
"""

from __future__ import annotations

import ast
import difflib
import enum
import functools
import inspect
import os
import re
from collections.abc import Callable, Iterable, Mapping
from types import ModuleType
from typing import Any

from .errors import ArgumentError

_SOURCES = {"Sensor": "load_sensor()", "Scene": "load_scene()", "Device": "Device.open()", "Mesh": "load_mesh()"}


def describe(core: ModuleType, route_constructor: Callable[[type], None]) -> None:
    """Wraps all functions, methods and constructors of `core`. route_constructor: lets cls(...) call the method cls._construct()."""
    for name, member in list(vars(core).items()):
        if _is_function(member):
            setattr(core, name, _wrapped(member, name, core))
        elif isinstance(member, type) and not issubclass(member, enum.Enum):
            _describe_class(member, route_constructor, core)


def _is_function(member: object) -> bool:
    return type(member).__name__ in ("nb_func", "nb_method")


def _describe_class(cls: Any, route_constructor: Callable[[type], None], core: ModuleType) -> None:
    for name, member in list(vars(cls).items()):
        if _is_function(member) and not name.startswith("__"):
            wrapped = _wrapped(member, f"{cls.__name__}.{name}", core)
            setattr(cls, name, wrapped if type(member).__name__ == "nb_method" else staticmethod(wrapped))
    if _is_function(cls.__init__):
        cls._construct = _wrapped(cls.__init__, cls.__name__, core)
        _, *parameters = cls._construct.__signature__.parameters.values()
        cls.__signature__ = inspect.Signature(parameters)
        del cls.__init__
    else:
        cls._construct = _refuse_construction
    route_constructor(cls)


def _refuse_construction(self: object, *args: Any, **kwargs: Any) -> None:
    maker = re.search(r"Made by (.*?\))", type(self).__doc__ or "")
    raise ArgumentError(f"{type(self).__name__}() is no constructor: " + (f"use {maker[1]}" if maker else "functions return these objects"))


def _wrapped(function: Any, name: str, core: ModuleType) -> Any:
    """`function` with a signature; it raises ArgumentError for arguments that none of its overloads takes."""
    signatures = [_signature(text, defaults or ()) for text, _, defaults in function.__nb_signature__]
    refusal = f"{function.__name__}(): incompatible function arguments"

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            return function(*args, **kwargs)
        except TypeError as error:
            if not str(error).startswith(refusal):
                raise
        nearest = max(_problem(signature, args, kwargs, core) for signature in signatures)
        raise ArgumentError(f"{name}(): {nearest[1]}")

    call.__signature__ = signatures[0]  # type: ignore[attr-defined]
    return call


def _signature(text: str, defaults: tuple[Any, ...]) -> inspect.Signature:
    r"""Of "def name(...) -> ...", in which \0, \1, ... stand for `defaults`, and "ndarray[shape=(*, 3)]" for an array."""
    text = re.sub(r"\\=?(\d+)", r"_\1", re.sub(r"\b(?:\w+\.)*ndarray\[[^]]*\]", "NDArray", text))
    definition: Any = ast.parse(f"{text}: ...").body[0]
    found = definition.args

    def parameter(kind: Any, argument: ast.arg, default: ast.expr | None) -> inspect.Parameter:
        value: Any = inspect.Parameter.empty
        if default is not None:
            value = defaults[int(default.id[1:])] if isinstance(default, ast.Name) else ast.literal_eval(default)
        annotation = inspect.Parameter.empty if argument.annotation is None else _short(argument.annotation)
        return inspect.Parameter(argument.arg, kind, default=value, annotation=annotation)

    kind = inspect.Parameter
    positional = [(kind.POSITIONAL_ONLY, each) for each in found.posonlyargs] + [(kind.POSITIONAL_OR_KEYWORD, each) for each in found.args]
    values = [None] * (len(positional) - len(found.defaults)) + found.defaults
    parameters = [parameter(each, argument, value) for (each, argument), value in zip(positional, values, strict=True)]
    parameters += [parameter(kind.VAR_POSITIONAL, found.vararg, None)] if found.vararg else []
    parameters += [parameter(kind.KEYWORD_ONLY, *each) for each in zip(found.kwonlyargs, found.kw_defaults, strict=True)]
    parameters += [parameter(kind.VAR_KEYWORD, found.kwarg, None)] if found.kwarg else []
    return inspect.Signature(parameters, return_annotation=_short(definition.returns))


def _short(annotation: ast.expr) -> str:
    """An annotation without modules: "Sequence[Sensor]"."""
    return re.sub(r"\b(?:\w+\.)*(?:_core|abc|typing|typing_extensions|os)\.(?=\w)", "", ast.unparse(annotation))


def _problem(signature: inspect.Signature, args: tuple[Any, ...], kwargs: Mapping[str, Any], core: ModuleType) -> tuple[int, str]:
    """Number of arguments that fit, -1 if they cannot be assigned to parameters, and what is wrong."""
    parameters = {name: each for name, each in signature.parameters.items() if name != "self"}
    names = ", ".join(parameters) or "none"
    for name in kwargs:
        if name not in parameters:
            near = difflib.get_close_matches(name, parameters, n=1)
            return -1, f"unknown argument {name}: " + (f"did you mean {near[0]}?" if near else names)
    try:
        bound = signature.bind(*args, **kwargs).arguments
    except TypeError as error:
        is_position = str(error) == "too many positional arguments"
        return -1, f"too many arguments without a name: {names}" if is_position else str(error)
    bound.pop("self", None)
    for number, (name, value) in enumerate(bound.items()):
        if wrong := _mismatch(value, ast.parse(parameters[name].annotation, mode="eval").body, name, core):
            return number, wrong
    return len(bound), _wrong_value(bound, parameters)


def _wrong_value(bound: Mapping[str, Any], parameters: Mapping[str, inspect.Parameter]) -> str:
    """Of arguments whose types fit: a sequence of another length than its default, a number out of range."""
    for name, value in bound.items():
        default = parameters[name].default
        if isinstance(default, list) and default and hasattr(value, "__len__") and len(value) != len(default):
            return f"{name}: {len(value)} values are not allowed: {len(default)}"
        if isinstance(value, int) and not 0 <= value < 2**31:
            return f"{name}: {value} found, which is out of range"
    found = ", ".join(f"{name} {_text(value)}" for name, value in bound.items())
    return f"{found} is not allowed: {', '.join(f'{name} {parameters[name].annotation}' for name in bound)}"


def _mismatch(value: Any, annotation: ast.expr, name: str, core: ModuleType) -> str | None:
    """What was found and what is allowed, unless `value` fits the annotation."""
    options = _options(annotation)
    kinds = [ast.unparse(option) for option in options]
    for native in map(functools.partial(_native, core), kinds):
        if isinstance(native, type) and issubclass(native, enum.Enum):
            members = {each.lower() for each in native.__members__}
            fits = isinstance(value, native) or (isinstance(value, str) and value.lower() in members)
            return None if fits else f"{name}: {_text(value)} is not allowed: {', '.join(sorted(members))}"
    elements: str | None = None
    for option in options:
        inside = _wrong_element(value, option, name, core)
        if inside is None and _fits(value, option, core):
            return None
        elements = elements or inside
    allowed = " or ".join(filter(None, (", ".join(kinds[:-1]), kinds[-1])))
    source = next((f"; use {_SOURCES[kind]}" for kind in kinds if kind in _SOURCES), "")
    return elements or f"{name}: {_text(value)} is not allowed: {allowed}{source}"


def _options(annotation: ast.expr) -> list[ast.expr]:
    if isinstance(annotation, ast.BinOp):
        return [*_options(annotation.left), *_options(annotation.right)]
    return [annotation]


def _wrong_element(value: Any, option: ast.expr, name: str, core: ModuleType) -> str | None:
    """Of the first wrong element, if `option` is a sequence and `value` is one."""
    if not (isinstance(option, ast.Subscript) and ast.unparse(option.value) == "Sequence" and isinstance(value, list | tuple)):
        return None
    return next(filter(None, (_mismatch(each, option.slice, f"{name}[{i}]", core) for i, each in enumerate(value))), None)


def _fits(value: Any, option: ast.expr, core: ModuleType) -> bool:
    """Whether `value` is of a kind, as far as its name says; its elements and its range are not looked at."""
    kind = ast.unparse(option.value if isinstance(option, ast.Subscript) else option)
    is_scalar = getattr(value, "ndim", 0) == 0
    native = _native(core, kind)
    checks: dict[str, Callable[[], bool]] = {
        "float": lambda: is_scalar and (hasattr(value, "__float__") or hasattr(value, "__index__")),
        "int": lambda: is_scalar and hasattr(value, "__index__"),
        "bool": lambda: type(value).__name__ in ("bool", "bool_"),
        "str": lambda: isinstance(value, str),
        "PathLike": lambda: isinstance(value, str | os.PathLike),
        "None": lambda: value is None,
        "Sequence": lambda: isinstance(value, Iterable) and not isinstance(value, str | bytes),
        "tuple": lambda: isinstance(value, list | tuple),
        "Mapping": lambda: isinstance(value, Mapping),
        "Callable": lambda: callable(value),
    }
    return checks[kind]() if kind in checks else native is None or isinstance(value, native)


def _native(core: ModuleType, kind: str) -> Any:
    """The class of `core` with a name such as "Psf.Normalization"; None for other names."""
    scope: Any = core
    for name in kind.split("."):
        scope = getattr(scope, name, None)
    return scope


def _text(value: Any) -> str:
    """Type of a value, and the value if it is short."""
    kind = "None" if value is None else type(value).__name__
    if isinstance(value, list | tuple):
        return f"{kind} of {len(value)}"
    return f"{kind} {value!r:.40}" if isinstance(value, str | int | float) else kind
