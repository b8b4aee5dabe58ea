"""Makes functions of the C++ module look like Python's: with a signature, and errors that do not print whole arrays.

Bindings know neither names nor defaults of their arguments in a form that `inspect` reads. The stubs do, and a test
compares them with the module.
"""

import ast
import functools
import inspect
import pathlib
import types

_INVOKED = "\n\nInvoked with: "
_ANY = inspect.signature(lambda *arguments, **keywords: None)  # of overloaded functions


def _signatures():
    """The signature of each function in the stubs by its name, "f" or "Class.f"; overloaded ones are left out."""
    found, overloaded = {}, set()

    def add(prefix, nodes):
        for node in nodes:
            if isinstance(node, ast.ClassDef):
                add(node.name + ".", node.body)
            elif isinstance(node, ast.FunctionDef):
                name = prefix + node.name
                if name in found:
                    overloaded.add(name)
                found[name] = _signature(node.args)

    add("", ast.parse(pathlib.Path(__file__).with_name("_kinloop.pyi").read_text(encoding="utf-8")).body)
    return {name: signature for name, signature in found.items() if name not in overloaded}


def _signature(arguments):
    """Of the arguments of a function definition; without types, which the stubs are for."""
    kinds, empty = inspect.Parameter, inspect.Parameter.empty
    names = arguments.posonlyargs + arguments.args
    defaults = [None] * (len(names) - len(arguments.defaults)) + arguments.defaults

    def parameter(argument, kind, default=None):
        return kinds(argument.arg, kind, default=empty if default is None else ast.literal_eval(default))

    parameters = [parameter(name, kinds.POSITIONAL_OR_KEYWORD, default) for name, default in zip(names, defaults)]
    if arguments.vararg:
        parameters.append(parameter(arguments.vararg, kinds.VAR_POSITIONAL))
    for name, default in zip(arguments.kwonlyargs, arguments.kw_defaults):
        parameters.append(parameter(name, kinds.KEYWORD_ONLY, default))
    if arguments.kwarg:
        parameters.append(parameter(arguments.kwarg, kinds.VAR_KEYWORD))
    return inspect.Signature(parameters)


def _described(value):
    shape = getattr(value, "shape", None)
    name = type(value).__name__
    return name if shape is None else f"{name} of {value.dtype}, shape {tuple(shape)}"


def _wrapped(function, signature):
    """The function with a signature (None: overloaded), and with the types of wrong arguments in place of their values."""

    @functools.wraps(function)
    def call(*arguments, **keywords):
        try:
            return function(*arguments, **keywords)
        except TypeError as error:
            text, invoked, _ = str(error).partition(_INVOKED)
            if not invoked:
                raise
            given = [_described(value) for value in arguments] + [f"{k}: {_described(v)}" for k, v in keywords.items()]
        raise TypeError(f"{text}{_INVOKED}{', '.join(given)}")

    call.__signature__ = signature or _ANY
    return call


def make_pythonic(namespace, names):
    """Wraps the functions of these names in the namespace, and the methods and constructors of its classes."""
    signatures = _signatures()
    for name in names:
        value = namespace[name]
        if not isinstance(value, type):
            namespace[name] = _wrapped(value, signatures.get(name))
        elif not issubclass(value, BaseException):
            _wrap_members(value, signatures)


def _wrap_members(owner, signatures):
    for name, member in list(vars(owner).items()):
        signature = signatures.get(f"{owner.__name__}.{name}")
        if name.startswith("__") and name != "__init__":
            continue
        if isinstance(member, staticmethod):
            setattr(owner, name, staticmethod(_wrapped(member.__func__, signature)))
        elif callable(member) and not isinstance(member, (type, types.FunctionType)):
            setattr(owner, name, _wrapped(member, signature))
