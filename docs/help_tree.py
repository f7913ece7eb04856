# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
"""Reads what a program says about itself with --help, and its sub-commands about themselves, into a tree.

Manual pages and shell completion are written from this tree, so that they cannot differ from the programs. Knows the layout
that CLI11 prints: description, "Usage: ...", sections of entries indented by two blanks, then a footer.
"""
import dataclasses
import os
import re
import subprocess

COLUMN = 30  # where texts begin
ENTRY = re.compile(r"^  (\S.*?)(?: {2,}(\S.*))?$")
TAKES_NOTHING = re.compile(r"^(--?[\w-]+(\{\w+\})?)(,--?[\w-]+(\{\w+\})?)*$")


@dataclasses.dataclass
class Entry:
    """An option, a positional argument or a sub-command."""
    head: str  # "--clock TEXT:{wall,cpu}=wall"
    text: str = ""

    @property
    def names(self):
        """["-h", "--help"]"""
        return [re.sub(r"\{\w+\}$", "", name) for name in self.head.split()[0].split(",")]

    @property
    def takes_value(self):
        return not TAKES_NOTHING.match(self.head)

    @property
    def is_required(self):
        return bool(re.search(r"\bREQUIRED\b", self.head))

    @property
    def type(self):
        """"TEXT", "INT", "ENUM"; empty where there is no value."""
        words = self.head.split()
        return re.split(r"[:=]", words[1])[0] if len(words) > 1 else ""

    @property
    def choices(self):
        """What the value is one of; empty when it may be anything."""
        found = re.search(r"(?:TEXT:|value in )\{([^}]*)\}", self.head)
        return [choice.split("->")[0] for choice in found.group(1).split(",")] if found else []

    @property
    def default(self):
        found = re.search(r"(?<!\()=(\S.*?)(?: REQUIRED| \.\.\.| Needs:.*)?$", self.head) if "SIZE [" not in self.head else None
        return found.group(1) if found else ""

    @property
    def range(self):
        """"1 - 600000", empty when unlimited."""
        found = re.search(r"in \[([^\]]*)\]", self.head)
        return found.group(1) if found else ""


@dataclasses.dataclass
class Command:
    path: list  # ["camloc", "map", "info"]
    description: str = ""
    usage: str = ""
    options: list = dataclasses.field(default_factory=list)
    positionals: list = dataclasses.field(default_factory=list)
    subcommands: list = dataclasses.field(default_factory=list)  # of Command
    footer: str = ""

    def walk(self):
        yield self
        for command in self.subcommands:
            yield from command.walk()


def parse_help(text):
    """(description, usage, {section: [Entry]}, footer) of one --help."""
    description, usage, sections, footer = [], "", {}, []
    entries = None  # of the section that is being read
    lines = text.splitlines()
    for number, line in enumerate(lines):
        if not usage:
            if line.startswith("Usage: "):
                usage = line.removeprefix("Usage: ").strip()
            else:
                description.append(line)
        elif line in ("Options:", "Positionals:", "Subcommands:") and not footer:
            entries = sections.setdefault(line[:-1], [])
        elif entries is not None and not footer and line.startswith(" " * COLUMN) and entries:
            entries[-1].text = f"{entries[-1].text} {line.strip()}".strip()
        elif entries is not None and not footer and ENTRY.match(line):
            head, entry_text = ENTRY.match(line).groups()
            is_continued = number + 1 < len(lines) and lines[number + 1].startswith(" " * COLUMN)
            if not entry_text and not is_continued and line[COLUMN - 1:COLUMN] == " ":
                head, entry_text = line[2:COLUMN - 1], line[COLUMN:]  # a head that just fits leaves one blank
            entries.append(Entry(head, entry_text or ""))
        elif line or footer:
            footer.append(line)
    return "\n".join(description).strip(), usage, sections, "\n".join(footer).strip("\n")


def read_help(program, path):
    arguments = [program, *path[1:], "--help"]
    run = subprocess.run(arguments, capture_output=True, text=True, timeout=60, env={**os.environ, "COLUMNS": "80"})
    if run.returncode != 0 or "Usage:" not in run.stdout:
        raise SystemExit(f"{' '.join(arguments)} gave no help, exit code {run.returncode}: {run.stderr.strip()}")
    return run.stdout


def read_command(program, path):
    """The tree of a program; `path` is what a user types, e.g. ["camloc"]."""
    description, usage, sections, footer = parse_help(read_help(program, path))
    command = Command(path, description, usage, sections.get("Options", []), sections.get("Positionals", []), [], footer)
    for entry in sections.get("Subcommands", []):
        command.subcommands.append(read_command(program, path + [entry.names[0]]))
    return command
