#!/usr/bin/env python3
"""Prints the reference of the Python package as a page of the site: signatures of the stubs, texts of the module.

Usage: python_reference.py FOLDER     the folder with the built package, e.g. build/release/python
"""
import ast
import importlib
import inspect
import sys
import textwrap
from pathlib import Path

WIDTH = 80  # letters of a line of code on the page


def fenced(language, text):
    return f"```{language}\n{text}\n```"


def signatures(functions):
    """Those of a function and its overloads, without self."""
    lines = []
    for function in functions:
        function.args.args = [argument for argument in function.args.args if argument.arg != "self"]
        signature = f"{function.name}({ast.unparse(function.args)}) -> {ast.unparse(function.returns)}"
        lines.append(textwrap.fill(signature, WIDTH, subsequent_indent="    ", break_on_hyphens=False))
    return fenced("python", "\n".join(lines))


def text_of(thing):
    """The first sentence of a docstring as text, the rest as it is laid out."""
    first, _, rest = (inspect.getdoc(thing) or "").partition("\n\n")
    return [first, *([fenced("text", rest)] if rest else [])]


def is_property(function):
    return any(ast.unparse(decorator) == "property" for decorator in function.decorator_list)


def function_page(name, functions, thing, level):
    return ["#" * level + f" {name}", signatures(functions), *text_of(thing)]


def class_page(node, thing):
    page = [f"## {node.name}", *text_of(thing)]
    members = {}
    for member in node.body:
        if isinstance(member, ast.FunctionDef):
            members.setdefault(member.name, []).append(member)
    properties = {name: found[0] for name, found in members.items() if is_property(found[0])}
    if properties:
        rows = [f"| `{name}` | `{ast.unparse(found.returns)}` | {inspect.getdoc(getattr(thing, name))} |".replace("\n", " ")
                for name, found in properties.items()]
        page.append("\n".join(["| property | type | |", "|---|---|---|", *rows]))
    for name, found in members.items():
        if name not in properties and not name.startswith("__"):
            page += function_page(f"{node.name}.{name}", found, getattr(thing, name), 3)
    return page


def main():
    folder = Path(sys.argv[1])
    sys.path.insert(0, str(folder))
    module = importlib.import_module("kinloop")
    stubs = ast.parse((folder / "kinloop/_kinloop.pyi").read_text())
    page = ["# Python reference", "[kinloop in Python](python.md) is the guide.", *text_of(module)]
    functions = {}
    for node in stubs.body:
        if isinstance(node, ast.FunctionDef):
            functions.setdefault(node.name, []).append(node)
    page += [part for name, found in functions.items() for part in function_page(name, found, getattr(module, name), 2)]
    for node in stubs.body:
        if isinstance(node, ast.ClassDef):
            page += class_page(node, getattr(module, node.name))
    print("\n\n".join(part for part in page if part))


if __name__ == "__main__":
    main()
