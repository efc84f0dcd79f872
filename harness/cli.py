"""The command `crosstrace`: what it offers, and how it ends.

A command's module is imported only when it is called, and nothing heavy before it is needed, so
that `crosstrace --help` answers at once. Exit status: 0 all is well, 1 a scene disagrees, 2 wrong
usage or bad input, 3 a renderer is missing or failed, 130 interrupted.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import Any

import click

from crosstrace.translators.errors import CrosstraceError, RendererError

USAGE, RENDERER, INTERRUPTED = 2, 3, 130

#: Command → the line that `--help` shows. Each stands in `commands/<name>.py` as `command`.
COMMANDS = {
    "run": "Render scenes with every renderer, compare them, write a report.",
    "render": "Render one image.",
    "translate": "Write a scene in another renderer's language.",
    "compare": "Compare two images.",
    "effects": "Say which effects a scene calls for.",
    "report": "Draw the page of a report.json again.",
    "doctor": "Say which renderers work here.",
}


class LazyGroup(click.Group):
    """A group whose commands are imported when they are called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands in the order of the table."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return a command."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f"crosstrace.harness.commands.{cmd_name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands from the table, without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _print_version(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        from importlib.metadata import version

        click.echo(f"crosstrace {version('crosstrace')}")
        ctx.exit()


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_print_version,
    help="Show the version and exit.",
)  # fmt: skip
def group() -> None:
    """Cross-validate ray tracers: one scene, independent renderers, every difference named.

    A SCENE is a file in the course's format, a folder of such files, or the name of a packaged
    scene (such as vidro4). No scene named: all packaged course scenes.
    """


def main(arguments: list[str] | None = None) -> Any:
    """Run the command line and end the process with its exit status."""
    try:
        status = group.main(args=arguments, prog_name="crosstrace", standalone_mode=False)
        sys.stdout.flush()
    except click.exceptions.Abort:
        _end(INTERRUPTED, "interrupted")
    except KeyboardInterrupt:
        _end(INTERRUPTED, "interrupted")
    except click.ClickException as error:
        error.show()
        sys.exit(USAGE)
    except BrokenPipeError:
        # The reader has seen enough; nothing may be written at exit either.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except CrosstraceError as error:
        _end(RENDERER if isinstance(error, RendererError) else USAGE, str(error))
    sys.exit(status if isinstance(status, int) else 0)


def _end(status: int, text: str) -> None:
    click.echo(f"crosstrace: {text}", err=True)
    sys.exit(status)
