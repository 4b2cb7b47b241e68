# SPDX-License-Identifier: BSD-3-Clause
"""Bash completion of a program's options, subcommands and choices."""
import cli_help

SCRIPT = """\
# Bash completion of {name}, made of `{name} --help`.
{function}() {{
    local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD - 1]}} command= words= files=no word
    COMPREPLY=()
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
        case "$command/$word" in
            {commands}) command=$command/$word ;;
        esac
    done
    case "$command $prev" in
{values}
    esac
    case $command in
{words}
    esac
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
    if [ "$files" = yes ] && [ "${{cur#-}}" = "$cur" ]; then
        compopt -o filenames 2>/dev/null
        mapfile -t -O ${{#COMPREPLY[@]}} COMPREPLY < <(compgen -f -- "$cur")
    fi
}}
complete -F {function} {name}
"""


def key(command):
    return "".join("/" + name for name in command.path[1:])


def value_cases(command):
    """Of each option with a value, what completes the value."""
    for option in command.options:
        if not option.takes_value:
            continue
        pattern = "|".join(f'"{key(command)} {name}"' for name in option.names)
        if option.choices:
            action = f'mapfile -t COMPREPLY < <(compgen -W "{" ".join(option.choices)}" -- "$cur")'
        elif option.takes_path:
            action = 'compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$cur")'
        else:
            action = ":"
        yield f"        {pattern}) {action}; return ;;"


def word_case(command):
    words = [below.path[-1] for below in command.subcommands]
    words += [name for option in command.options for name in option.names if name.startswith("--")]
    files = "; files=yes" if any(p.takes_path for p in command.positionals) else ""
    return f'        "{key(command)}") words="{" ".join(words)}"{files} ;;'


def script(top):
    name = top.path[0]
    all_commands = list(cli_help.walk(top))
    below = [key(command) for command in all_commands if len(command.path) > 1]
    return SCRIPT.format(name=name, function="_" + name.replace("-", "_") + "_options", commands="|".join(below) or "/",
                         values="\n".join(line for command in all_commands for line in value_cases(command)),
                         words="\n".join(word_case(command) for command in all_commands))
