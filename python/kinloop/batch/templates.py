"""Texts with placeholders in braces, such as {output}; {{ and }} stand for braces. Each is filled in one pass, so that braces in
what is filled in stay as they are."""

import string


def placeholders(template):
    """The names in braces. Throws ValueError for anything else in braces, such as the width in {name:>9}."""
    names = set()
    for _, name, width, conversion in string.Formatter().parse(template):
        if width or conversion:
            raise ValueError(f"'{{{name}' is followed by more than a brace")
        names |= {name} - {None}
    return names


def filled(template, values, literal=str):
    """The template with its placeholders replaced by `values`. `literal`: what becomes of the text between them."""
    parts = string.Formatter().parse(template)
    return "".join(literal(text) + ("" if name is None else str(values[name])) for text, name, _, _ in parts)


def as_template(text):
    """A text as a template without placeholders."""
    return str(text).replace("{", "{{").replace("}", "}}")
