"""A lane with a planted fault, in a worker process: a fault may well crash or hang a renderer."""

from __future__ import annotations

from crosstrace.harness import alone, tasks
from crosstrace.harness.faults.catalogue import fault
from crosstrace.harness.faults.fault import Fault
from crosstrace.harness.jobs import Task
from crosstrace.translators.renderer import Progress, Renderer, Rendering, RenderOptions
from crosstrace.translators.scene import Scene


def render_here(
    name: str, lane: str, scene: Scene, options: RenderOptions, progress: Progress | None = None
) -> Rendering | None:
    """Render with a fault in this process, as a worker does: every argument is plain data."""

    def draw(renderer: Renderer, given: Scene, told: RenderOptions) -> Rendering:
        return tasks.drawn(renderer, given, told, progress)[0]

    return fault(name).render(lane, scene, options, draw)


def render_with(
    broken: Fault | str, lane: str, scene: Scene, options: RenderOptions | None = None
) -> Rendering | None:
    """Render with a fault in a worker; None where the scene has nothing to break.

    `options.timeout_s` bounds the whole call. Raises UsageError for a fault or a lane that cannot
    be, otherwise as `alone.render`.
    """
    known = fault(broken) if isinstance(broken, str) else broken
    known.kind(lane)
    options = options or RenderOptions(timeout_s=alone.TIMEOUT_S)
    task = planted(known.name, lane, options)
    made: Rendering | None = alone.call(task, known.name, lane, scene, options)
    return made


def planted(name: str, lane: str, options: RenderOptions) -> Task:
    """Return the task that takes the arguments of `render_here`; a lane's worker serves it."""
    label = f"{lane} with the fault {name}"
    return Task(render_here, lane, timeout_s=options.timeout_s, label=label)
