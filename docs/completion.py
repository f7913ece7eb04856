#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Writes shell completion for bash: the engine in completion/engine.bash, and tables from what the programs say about themselves.

Usage: completion.py OUTPUT_FOLDER --engine FILE --sources LISTER --program FILE NAME [--program FILE NAME ...]

One file for each program, named after it, as bash-completion looks for it. camloc completes the commands of camloc-map and its
other programs, too.
"""
import argparse
import os
import re
import subprocess

import help_tree

# What a value is, by the option's name, where its type says only TEXT. Everything else of that type is a file.
KINDS = {
    "--map": "map", "--extend": "map", "--camera": "camera", "--sequence": "source", "--source": "source", "--set": "setting",
    "--config": "toml", "--out-dir": "folder", "--colmap": "folder", "--reference-sequence": "folder",
    "--name": "none", "--perturb": "none", "--frames": "none", "--exclude": "none", "--channel": "none", "--status-channel": "none", "--lcm-url": "none",
}


def kind_of(entry):
    """"file", "none", ... or "=a b c" for a choice."""
    if entry.choices:
        return "=" + " ".join(entry.choices)
    if entry.type not in ("TEXT", ""):
        return "none"
    if entry.head[0] != "-":  # positional
        return "map" if re.match(r"(MAP|FIRST|SECOND)\b", entry.head, re.IGNORECASE) else "file"
    return KINDS.get(entry.names[-1], "file")


def quote(text):
    return "'" + text.replace("'", "'\\''") + "'"


def table_lines(tree):
    """Entries of the tables: sub-commands, options and kinds of values of every command."""
    lines = []
    for command in tree.walk():
        path = " ".join(command.path)
        options = " ".join(name for entry in command.options for name in entry.names)
        subcommands = " ".join(subcommand.path[-1] for subcommand in command.subcommands)
        lines.append(f"  [{quote(path + ' options')}]={quote(options)}")
        lines.append(f"  [{quote(path + ' commands')}]={quote(subcommands)}")
        if command.positionals:
            lines.append(f"  [{quote(path + ' positional')}]={quote(kind_of(command.positionals[0]))}")
        for entry in command.options:
            if entry.takes_value:
                lines += [f"  [{quote(path + ' ' + name)}]={quote(kind_of(entry))}" for name in entry.names]
    return lines


def graft(tree, programs):
    """Hangs the trees of camloc-NAME below camloc as the command NAME."""
    for name, other in programs.items():
        if not name.startswith("camloc-"):
            continue
        other = help_tree.read_command(other, [name])
        word = name.removeprefix("camloc-")
        target = next((command for command in tree.subcommands if command.path[-1] == word), None)
        if target is None:
            target = help_tree.Command(["camloc", word], options=other.options, positionals=other.positionals)
            tree.subcommands.append(target)
        for command in other.walk():
            command.path = ["camloc", word, *command.path[1:]]
        target.subcommands += other.subcommands


def setting_names(camlocd):
    run = subprocess.run([camlocd, "--config", "/dev/null", "--print-config"], capture_output=True, text=True, check=True, timeout=60)
    names, section = [], ""
    for line in run.stdout.splitlines():
        if found := re.fullmatch(r"\[(\w+)\]", line):
            section = found.group(1)
        elif found := re.match(r"(\w+) = ", line):
            names.append(f"{section}.{found.group(1)}")
    return names


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--engine", required=True)
    parser.add_argument("--sources", required=True)
    parser.add_argument("--program", nargs=2, action="append", required=True)
    options = parser.parse_args()

    programs = {name: path for path, name in options.program}
    sources = subprocess.run([options.sources], capture_output=True, text=True, check=True, timeout=60).stdout.splitlines()
    schemes = " ".join(line.split("\t")[0] + "://" for line in sources)
    settings = " ".join(setting_names(programs["camlocd"])) if "camlocd" in programs else ""
    with open(options.engine, encoding="utf-8") as file:
        engine = file.read()
    os.makedirs(options.folder, exist_ok=True)
    for name, path in programs.items():
        tree = help_tree.read_command(path, [name])
        if name == "camloc":
            graft(tree, programs)
        text = engine.replace("@FUNCTION@", "_" + name.replace("-", "_")).replace("@PROGRAM@", name)
        text = text.replace("@SCHEMES@", schemes).replace("@SETTINGS@", settings).replace("@TABLE@", "\n".join(table_lines(tree)))
        with open(os.path.join(options.folder, name), "w", encoding="utf-8") as output:
            output.write(text)


if __name__ == "__main__":
    main()
