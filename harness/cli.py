"""The command `crosstrace`: which subcommands there are, and what ends with which exit status.

0: done, everything agrees or nothing was judged. 1: a scene disagrees. 2: wrong usage or bad input.
3: a renderer is missing or failed. 70: a fault of this program. 130: interrupted. Subcommands are
imported when they are called, and what they need inside them, so that help comes at once.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import click

from crosstrace.translators.errors import CrosstraceError, RendererError, SceneError

#: Subcommand → its line in the help. Each stands in the module of its name in `commands/`.
COMMANDS = {
    "run": "Render scenes through every renderer and write a report.",
    "render": "Render one scene with one renderer.",
    "translate": "Write a scene in another renderer's language.",
    "compare": "Compare two images.",
    "effects": "Say what a scene calls for, object by object.",
    "report": "Draw the page again from a report.json.",
    "doctor": "Say which renderers work here.",
}


class _Group(click.Group):
    """Imports a subcommand when it is called; the help needs none of them."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f"crosstrace.harness.commands.{cmd_name}")
        command: click.Command = module.command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _show_version(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        import crosstrace

        click.echo(f"crosstrace {crosstrace.__version__}")
        ctx.exit()


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_show_version,
    help="Print the version.",
)  # fmt: skip
def cli() -> None:
    """Render one scene through independent ray tracers and compare them pixel by pixel.

    A SCENE is a file of the course's format, a folder of them, or the name of a packaged scene.
    """


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command and end the process with its exit status."""
    signal.signal(signal.SIGTERM, _terminate)
    status = _status(sys.argv[1:] if arguments is None else list(arguments))
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        status = _reader_gone()
    sys.exit(status)


def _status(arguments: list[str]) -> int:
    try:
        with cli.make_context("crosstrace", arguments) as context:
            result: Any = cli.invoke(context)
            return result if isinstance(result, int) else 0
    except click.exceptions.Exit as end:
        return end.exit_code
    except click.ClickException as error:
        error.show()
        return 2
    except (KeyboardInterrupt, click.Abort):
        click.echo("crosstrace: interrupted", err=True)
        return 130
    except CrosstraceError as error:
        return _told(error)
    except BrokenPipeError:
        return _reader_gone()
    except Exception:
        import traceback

        traceback.print_exc()
        return 70


def _told(error: CrosstraceError) -> int:
    # A scene's error starts with the file's name, as editors expect it.
    prefix = "" if isinstance(error, SceneError) else "crosstrace: "
    click.echo(f"{prefix}{error}", err=True)
    return 3 if isinstance(error, RendererError) else 2


def _reader_gone() -> int:
    """Whoever read our output has left, as `head` does: end without a word."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return 128 + signal.SIGPIPE


def _terminate(number: int, _: Any) -> None:
    # An exception, so that workers are killed and scratch files removed on the way out.
    sys.exit(128 + number)
