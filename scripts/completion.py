# SPDX-License-Identifier: GPL-3.0-or-later
"""Completion of bash, zsh and fish for a program whose commands and options are known (manual.py)."""
import re


def walk(command, path=()):
    """Every command with the words that lead to it."""
    yield path, command
    for below in command["commands"]:
        yield from walk(below, (*path, below["name"]))


def names_of(command):
    return [name for option in command["options"] or () for name in option["names"]]


def choices(option):
    """The words that an option takes, where they are listed."""
    found = re.search(r":\{(.*)\}", option["value"])
    return found.group(1).split(",") if found else []


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def summary(text):
    """The first sentence of a help text on one line."""
    return re.split(r"(?<=[a-z)])\. ", " ".join(text.split()))[0].rstrip(".")


def bash(program):
    name = program["name"]
    function = "_" + name.replace("-", "_")
    lines = [f"# bash completion of {name}, made from its help", f"{function}() {{", "  local at= word i", '  COMPREPLY=()',
             "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}"]
    # The command that has been typed so far.
    paths = [" ".join(path) for path, _ in walk(program) if path]
    if paths:
        lines += ["  for ((i = 1; i < COMP_CWORD; i++)); do", "    word=${at:+$at }${COMP_WORDS[i]}", "    case $word in"]
        lines += [f"      {'|'.join(quoted(p) for p in paths)}) at=$word ;;"]
        lines += ["    esac", "  done"]
    lines += ['  case "$at:$before" in']
    for path, command in walk(program):
        for option in command["options"] or ():
            if not option["names"] or not option["value"]:
                continue
            where = "|".join(quoted(f"{' '.join(path)}:{n}") for n in option["names"])
            words = choices(option)
            answer = f'COMPREPLY=($(compgen -W {quoted(" ".join(words))} -- "$current"))' if words else 'COMPREPLY=($(compgen -f -- "$current")); compopt -o filenames 2>/dev/null'
            lines += [f"    {where}) {answer}; return ;;"]
    lines += ["  esac", '  case "$at" in']
    for path, command in walk(program):
        words = names_of(command)
        below = [c["name"] for c in command["commands"]]
        lines += [f"    {quoted(' '.join(path))})", '      if [[ $current == -* ]]; then',
                  f"        COMPREPLY=($(compgen -W {quoted(' '.join(words))} -- \"$current\"))"]
        if below:
            lines += ["      else", f"        COMPREPLY=($(compgen -W {quoted(' '.join(below))} -- \"$current\"))"]
        else:
            lines += ["      else", '        COMPREPLY=($(compgen -f -- "$current"))', "        compopt -o filenames 2>/dev/null"]
        lines += ["      fi ;;"]
    lines += ["  esac", "}", f"complete -F {function} {name}", ""]
    return "\n".join(lines)


def zsh_option(option):
    """One specification of _arguments an option's name."""
    text = summary(option["help"]).replace("\\", "\\\\").replace("[", "\\[").replace("]", "\\]").replace(":", "\\:")
    value = ""
    if option["value"]:
        words = choices(option)
        value = f":value:({' '.join(words)})" if words else ":value:_files"
    return [quoted(f"*{name}[{text}]{value}") for name in option["names"]]


def zsh(program):
    name = program["name"]
    lines = [f"#compdef {name}", f"# zsh completion of {name}, made from its help"]
    function = "_" + name.replace("-", "_")

    def write(command, path):
        own = "_".join([function, *path]).replace("-", "_")
        specs = [s for option in command["options"] or () for s in zsh_option(option)]
        lines.extend([f"{own}() {{", "  local context state line curcontext=$curcontext", "  typeset -A opt_args"])
        if command["commands"]:
            lines.extend(["  _arguments -C \\", *(f"    {s} \\" for s in specs), "    '1:command:->command' '*::argument:->argument'", "  case $state in", "    command)",
                          "      local -a commands=("])
            for below in command["commands"]:
                lines.append(f"        {quoted(below['name'] + ':' + summary(below['help']).replace(':', chr(92) + ':'))}")
            lines.extend(["      )", "      _describe command commands ;;", "    argument)", "      case $words[1] in"])
            for below in command["commands"]:
                lines.append(f"        {below['name']}) {'_'.join([function, *path, below['name']]).replace('-', '_')} ;;")
            lines.extend(["      esac ;;", "  esac", "}"])
        else:
            lines.extend(["  _arguments \\", *(f"    {s} \\" for s in specs), "    '*:file:_files'", "}"])
        for below in command["commands"]:
            write(below, (*path, below["name"]))

    write(program, ())
    return "\n".join([*lines, f'{function} "$@"', ""])


def fish(program):
    name = program["name"]
    lines = [f"# fish completion of {name}, made from its help"]
    for path, command in walk(program):
        below = " ".join(c["name"] for c in command["commands"])
        seen = "; and ".join(f"__fish_seen_subcommand_from {word}" for word in path)
        if not path:
            # Options of the program itself, before any command.
            seen = f"not __fish_seen_subcommand_from {below}" if below else ""
        elif below:
            seen += f"; and not __fish_seen_subcommand_from {below}"
        condition = f" -n {quoted(seen)}" if seen else ""
        for sub in command["commands"]:
            lines.append(f"complete -c {name} -f{condition} -a {sub['name']} -d {quoted(summary(sub['help']))}")
        for option in command["options"] or ():
            if not option["names"]:
                continue
            flags = "".join(f" -l {n[2:]}" if n.startswith("--") else f" -s {n[1:]}" for n in option["names"])
            words = choices(option)
            value = f" -x -a {quoted(' '.join(words))}" if words else " -r" if option["value"] else ""
            lines.append(f"complete -c {name}{condition}{flags}{value} -d {quoted(summary(option['help']))}")
    return "\n".join([*lines, ""])


# Shell: the file's name and what writes it.
SHELLS = {"bash": ("{}", bash), "zsh": ("_{}", zsh), "fish": ("{}.fish", fish)}
