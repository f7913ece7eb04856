#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Writes a manual page: a hand-written frame in roff, filled with what the program says about itself.

Usage: man_page.py FRAME OUTPUT --version V [--program FILE NAME] [--settings CAMLOCD] [--sources LISTER]

Lines of the frame that are replaced: @SYNOPSIS@, @OPTIONS@ and @COMMANDS@ from the --help of --program, @SETTINGS@ from the
--print-config of camlocd, @SOURCES@ from list_frame_sources; @VERSION@ anywhere.
"""
import argparse
import dataclasses
import re
import subprocess

import help_tree


def escape(text):
    """Text for roff: nothing in it is a request or an escape."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga").replace("^", "\\(ha").replace("~", "\\(ti")
    return "\n".join("\\&" + line if line.startswith(".") else line for line in text.split("\n"))


def bold(text):
    return f"\\fB{escape(text)}\\fR"


def italic(text):
    return f"\\fI{escape(text)}\\fR"


def verbatim(text):
    return f".PP\n.EX\n{escape(text)}\n.EE\n"


def value_name(entry):
    """What stands for the value: the choices, or the kind of thing in italics."""
    if entry.choices:
        return "|".join(bold(choice) for choice in entry.choices)
    kind = {"TEXT": "text", "INT": "number", "UINT": "number", "FLOAT": "number", "ENUM": "word"}
    return italic(kind.get(entry.type, entry.type.lower()))


def capitalized(text):
    """As a sentence begins, unless it begins with something that is not a word."""
    return text[:1].upper() + text[1:] if re.match(r"[a-z]+[ ,]", text) else text


def format_option(entry):
    head = ", ".join(bold(name) for name in entry.names)
    if entry.takes_value:
        head += " " + value_name(entry)
    notes = [f"{entry.range.replace(' - ', ' to ')}"] if entry.range else []
    if entry.is_required:
        notes.append("required")
    if entry.default:
        notes.append(f"default {entry.default}")
    text = capitalized(entry.text)
    if notes:
        text = (text.rstrip(".") + f" ({'; '.join(notes)}).").strip()
    else:
        text = sentence(text)
    return f".TP\n{head}\n{escape(text)}\n"


def is_help(entry):
    return entry.names[-1] in ("--help", "--version")


def format_arguments(command, with_help):
    """Positional arguments and options as a list."""
    out = ""
    for entry in command.positionals:
        notes = "" if entry.is_required else " (may be left out)"
        out += f".TP\n{italic(entry.head.split()[0].upper())}\n{escape(entry.text + notes)}.\n"
    return out + "".join(format_option(entry) for entry in command.options if with_help or not is_help(entry))


def sentence(text):
    text = capitalized(text)
    return text + "." if text and text[-1] not in ".:)" else text


def synopsis(command):
    words = [bold(" ".join(command.path))]
    for entry in command.options:
        if is_help(entry):
            continue
        text = bold(entry.names[-1]) + ("\\ " + value_name(entry) if entry.takes_value else "")
        words.append(text if entry.is_required else f"[{text}]")
    words += [italic(entry.head.split()[0].upper()) for entry in command.positionals]
    if command.subcommands:
        words.append("|".join(bold(subcommand.path[-1]) for subcommand in command.subcommands))
    return "\n".join(words) + "\n"


def format_commands(tree):
    """Every command with its options and its footer; one that only groups others when they share its options."""
    out = ""
    for command in tree.walk():
        arguments = format_arguments(command, with_help=False)
        if command is tree or (command.subcommands and not arguments):
            continue
        name = " ".join(command.path[1:])
        out += f".SS {escape(name)}\n{synopsis(command)}.PP\n{escape(sentence(command.description))}\n{arguments}"
        if command.footer and command.footer != tree.footer:
            out += verbatim(command.footer)
    return out


def format_synopsis(tree):
    commands = f"{bold(tree.path[0])}\n{italic('command')}\n[{italic('options')}]\n"
    if not tree.subcommands:
        return synopsis(tree)
    if all(is_help(entry) for entry in tree.options):
        return commands
    return synopsis(dataclasses.replace(tree, subcommands=[])) + ".br\n" + commands


def format_settings(camlocd):
    """Sections, keys and their explanations, from the file that --print-config writes."""
    run = subprocess.run([camlocd, "--config", "/dev/null", "--print-config"], capture_output=True, text=True, check=True, timeout=60)
    out, comments = "", []
    for line in run.stdout.splitlines():
        if section := re.fullmatch(r"\[(\w+)\]", line):
            out += f".SS [{section.group(1)}]\n"
            comments = []
        elif line.startswith("# "):
            comments.append(line[2:])
        elif setting := re.fullmatch(r"(\w+) = (.*)", line):
            key, value = setting.groups()
            out += f".TP\n{bold(key)} = {escape(value)}\n" + "\n.br\n".join(escape(comment) for comment in comments) + "\n"
            comments = []
    return out


def format_sources(lister):
    out = ""
    for line in subprocess.run([lister], capture_output=True, text=True, check=True, timeout=60).stdout.splitlines():
        usage, _, text = line.split("\t")[1].partition("  ")
        breakable = re.sub(r"([?&])", r"\\:\1", bold(usage))  # a long URL may be broken before its options
        out += f".TP\n{breakable}\n{escape(capitalized(text))}.\n"
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frame")
    parser.add_argument("output")
    parser.add_argument("--version", required=True)
    parser.add_argument("--program", nargs=2)
    parser.add_argument("--settings")
    parser.add_argument("--sources")
    options = parser.parse_args()

    tree = help_tree.read_command(options.program[0], [options.program[1]]) if options.program else None
    parts = {
        "@SYNOPSIS@": lambda: format_synopsis(tree),
        "@OPTIONS@": lambda: format_arguments(tree, with_help=True),
        "@COMMANDS@": lambda: format_commands(tree),
        "@SETTINGS@": lambda: format_settings(options.settings),
        "@SOURCES@": lambda: format_sources(options.sources),
    }
    with open(options.frame, encoding="utf-8") as frame:
        page = "".join(parts[line.strip()]() if line.strip() in parts else line for line in frame)
    with open(options.output, "w", encoding="utf-8") as output:
        output.write(page.replace("@VERSION@", options.version))


if __name__ == "__main__":
    main()
