"""The command `crosstrace`: finds the subcommand, and turns errors into exit statuses.

Exit status: 0; 1 where a scene disagrees or a check fails; 2 for wrong usage or bad input; 3 where
a renderer is missing or failed; 130 after an interrupt. Each command stands in a module of its own
that is imported when it is called for, so that help costs nothing.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NoReturn

import click

from crosstrace.harness.outcome import OK, RENDERER_FAILED

BAD_INPUT = 2
#: The customary ones, for what the statuses of the design do not name.
INTERNAL_ERROR, INTERRUPTED, BROKEN_PIPE, TERMINATED = 70, 130, 141, 143

#: Command → its line in the overview, so that the overview imports none of them.
COMMANDS = {
    "run": "Render scenes through every renderer, compare, and write a report.",
    "render": "Render one scene with one renderer to an image file.",
    "translate": "Write a scene in another renderer's own language.",
    "compare": "Compare two images in numbers.",
    "explain": "Show the rays of one pixel, its true value, and every lane's.",
    "check": "Render scenes again and hold them against their goldens.",
    "bless": "Accept new results as goldens, with a reason.",
    "effects": "Say what a scene calls for, object by object.",
    "stability": "Say how far the result can be trusted numerically.",
    "study": "Say what accuracy costs in time.",
    "bench": "Measure the native tracer against its peers.",
    "report": "Draw the page again from a report.json.",
    "doctor": "Say which renderers work here, and how to install what is missing.",
}


class _Lazy(click.Group):
    """A group that imports a command's module when the command is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """List the commands in the order of the overview."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import a command."""
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f"crosstrace.harness.commands.{cmd_name}")
        command: click.Command = module.command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the overview without importing any command."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _print_version(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted:
        import crosstrace

        click.echo(f"crosstrace {crosstrace.__version__}")
        ctx.exit()


@click.group(
    "crosstrace",
    cls=_Lazy,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 80},
    epilog="A SCENE is a file in the course's format, a folder of such files, or the name of a "
    "packaged scene. `crosstrace COMMAND --help` says more.",
)
@click.option("--version", is_flag=True, is_eager=True, expose_value=False, help="Say the version.",
              callback=_print_version)  # fmt: skip
def group() -> None:
    """Render one scene with independent ray tracers and say where they differ."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit status."""
    _prepare()
    try:
        # Not `group.main`: it ends a broken pipe with 1, which here means that a scene disagrees.
        words = sys.argv[1:] if arguments is None else list(arguments)
        with group.make_context("crosstrace", words) as context:
            status = group.invoke(context)
        sys.stdout.flush()
    except click.exceptions.Exit as done:
        return done.exit_code
    except (KeyboardInterrupt, click.exceptions.Abort):
        click.echo("\ncrosstrace: interrupted", err=True)
        return INTERRUPTED
    except BrokenPipeError:
        _forget_output()
        return BROKEN_PIPE
    except Exception as error:
        return _status_of(error)
    return status if isinstance(status, int) else OK


def _status_of(error: Exception) -> int:
    if isinstance(error, click.ClickException):
        error.show()
        return error.exit_code
    from crosstrace.translators.errors import CrosstraceError, RendererError

    if not isinstance(error, CrosstraceError):
        # A defect of this program: its traceback is for us, and 1 would mean a disagreement.
        sys.excepthook(type(error), error, error.__traceback__)
        return INTERNAL_ERROR
    click.echo(f"crosstrace: {error}", err=True)
    return RENDERER_FAILED if isinstance(error, RendererError) else BAD_INPUT


def _prepare() -> None:
    """Let no name of a file break the output, and unwind where the process is asked to end."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure: Any = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="replace")
    signal.signal(signal.SIGTERM, _terminate)


def _terminate(*_: object) -> NoReturn:
    sys.exit(TERMINATED)


def _forget_output() -> None:
    """Have the interpreter's last flush go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
