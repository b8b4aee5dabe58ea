#!/usr/bin/env python3
"""Writes the completion of kinloop's command line for bash and zsh from the help of the program.

Usage: make_completion.py KINLOOP FOLDER     writes FOLDER/kinloop (bash) and FOLDER/_kinloop (zsh)
"""
import re
import sys
from pathlib import Path

from command_help import read_commands, read_options

# Sources that are no files, as the help of `kinloop run` names them.
SOURCES = ("sim:room", "kinect1", "kinect2", "openni2", "realsense", "orbbec", "oak")

BASH = """# bash completion of kinloop, made from its help.
_kinloop() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} command="" words=""
  # bash splits at "=": `--set key=` are three words
  if [[ $before == "=" || $word == "=" ]]; then return; fi
  case "${{COMP_WORDS[1]}} ${{COMP_WORDS[2]}}" in
{nested}
    *) command=${{COMP_WORDS[1]}} ;;
  esac
  if [[ $COMP_CWORD -eq 1 ]]; then command=""; fi
  if [[ $before == --set && $command =~ ^(run|mesh|export|map merge)$ ]]; then
    compopt -o nospace 2>/dev/null
    COMPREPLY=($(compgen -S = -W "{keys}" -- "$word"))
    return
  fi
  case "$command $before" in
{choices}
  esac
  if [[ -z $words ]]; then
    case "$command" in
{words}
    esac
    # After the commands' names and options: sources, else files.
    if [[ $word != -* && $words == -* ]]; then
      words=""
      if [[ -n $word ]]; then
        case "$command" in
{sources}
        esac
      fi
      if [[ $before == ":" && ${{COMP_WORDS[COMP_CWORD-2]}} == sim ]]; then words=${{words:+room}}; fi  # bash splits at ":"
    fi
  fi
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _kinloop kinloop
"""

ZSH = """#compdef kinloop
# zsh completion of kinloop, made from its help.
_kinloop() {{
  local -a commands
  if (( CURRENT == 2 )); then
    commands=({commands})
    _describe command commands
    return
  fi
  case "$words[2] $words[3]" in
{cases}
    *) _files ;;
  esac
}}
_kinloop "$@"
"""


def quote(text):
    return "'" + text.replace("'", "'\\''") + "'"


def first_words(command):
    """What may follow a command: its commands, and its options unless it only has commands."""
    return [row.left for row in command.subcommands] + (command.flags if command.positionals or not command.subcommands else [])


def named_sources(command, program):
    """The sources that the help of the command's arguments names, or that of `kinloop run` where it refers to that."""
    text = " ".join(row.text for row in command.positionals)
    if re.search(r"\bas (of|for) kinloop run\b", text):
        text += " ".join(row.text for child in program.children if child.name == "run" for row in child.positionals)
    return [name for name in SOURCES if re.search(rf"(?<![\w:]){name}(?![\w:])", text)]


def bash_completion(program, keys):
    commands = list(program.walk())
    nested = [f'    "{c.name}") command="{c.name}" ;;' for c in commands if " " in c.name]
    choices = [f'    "{c.name} {flag}") words="{" ".join(option.choices)}" ;;'
               for c in commands for option in c.options if option.choices for flag in option.flags]
    words = [f'      "{c.name}") words="{" ".join(first_words(c))}" ;;' for c in commands]
    sources = [f'          "{c.name}") words="{" ".join(named_sources(c, program))}" ;;'
               for c in commands if named_sources(c, program)]
    return BASH.format(nested="\n".join(nested), keys=" ".join(keys), choices="\n".join(choices), words="\n".join(words),
                       sources="\n".join(sources))


def zsh_option(option):
    text = option.text.replace("[", "(").replace("]", ")").replace(":", " -")
    value = ""
    if option.value and not option.value.startswith("["):
        value = ":value:" + (f"({' '.join(option.choices)})" if option.choices else "_files")
    flags = option.flags
    spec = flags[0] if len(flags) == 1 else "{" + ",".join(flags) + "}"
    return f"      {spec}{quote(f'[{text}]{value}')}"


def zsh_case(command, depth, program):
    pattern = f"'{command.name}'" if depth == 2 else f"'{command.name} '*"
    if command.children:
        rows = " ".join(quote(f"{row.left}:{row.text}") for row in command.subcommands)
        return f"    {pattern}) commands=({rows}); _describe command commands{'; _files' if command.positionals else ''} ;;"
    options = " \\\n".join(zsh_option(option) for option in command.options)
    shift = "shift words; (( CURRENT-- )); " * depth
    files = "'*:file:_files'"
    sources = " ".join(name.replace(":", "\\:") for name in named_sources(command, program))
    if sources:
        files = f"""'*:source:_alternative "sources:source:({sources})" "files:file:_files"'"""
    return f"    {pattern}) {shift}_arguments \\\n{options} \\\n      {files} ;;"


def zsh_completion(program):
    # the commands of a command first: their pattern is the narrower one
    inner = [zsh_case(grandchild, 2, program) for child in program.children for grandchild in child.children]
    outer = [zsh_case(child, 1, program) for child in program.children]
    commands = " ".join(quote(f"{row.left}:{row.text}") for row in program.subcommands)
    return ZSH.format(commands=commands, cases="\n".join(inner + outer))


def main():
    program_path, folder = sys.argv[1], Path(sys.argv[2])
    program = read_commands(program_path)
    keys = [key for key, _, _ in read_options(program_path, "--options=all")]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "kinloop").write_text(bash_completion(program, keys))
    (folder / "_kinloop").write_text(zsh_completion(program))


if __name__ == "__main__":
    main()
