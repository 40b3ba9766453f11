"""Figures and tables of docs/picking.md: FASTKIT's whole job, and the job in which a base tips.

Run: python docs/picking.py
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from generated import write_tables
from PIL import Image
from PIL.PngImagePlugin import PngInfo

import cdprlab as cl
from cdprlab import TorqueControl
from cdprlab.fastkit import frame_at, pick_and_place, plot_job
from cdprlab.fastkit.events import spans
from cdprlab.fastkit.job.phases import job_phases
from cdprlab.view import save_figure

DOCS = Path(__file__).parent
SHOWN = ("coupled", "deploy", "reach", "draw in", "carry", "push out")
LIGHT = 38.0    # kg: a base without its cabinet; chosen so that prestress tips it
STIFF = 45.0    # N


def strip(job):
    """Six pictures of a job, each in the middle of its phase."""
    moments = [(start + end) / 2 for start, end, state in spans(job.events, job.time[-1]) if state in SHOWN]
    frames = [np.asarray(frame_at(job, t)) for t in moments]
    rows = [np.concatenate(frames[i:i + 2], axis=1) for i in range(0, len(frames), 2)]
    return Image.fromarray(np.concatenate(rows))


def light(world):
    """The same world on bases of 38 kg, deployed already, the platform near the shelf."""
    bases = tuple(dataclasses.replace(base, mass=LIGHT) for base in world.robot.bases)
    task = dataclasses.replace(world.task("pick_and_place"), coupled={}, start=cl.Pose([0.8, 0, 0.6]))
    return dataclasses.replace(world, robot=dataclasses.replace(world.robot, bases=bases),
                               tasks={"pick_and_place": task})


def results(jobs):
    """A column a job."""
    keys = list(next(iter(jobs.values())).table())
    keys.remove("real-time factor")
    lines = ["| | " + " | ".join(jobs) + " |", "|---" * (len(jobs) + 1) + "|"]
    lines += [f"| {key} | " + " | ".join(job.table()[key] for job in jobs.values()) + " |" for key in keys]
    return "\n".join(lines)


def phases(world):
    """The state machine, one line a phase."""
    rows = [f"| {k} | `{phase.name}` | {phase.what} | {phase.duration:.1f} |"
            for k, phase in enumerate(job_phases(world, world.task("pick_and_place")), 1)]
    return "\n".join(["| | state | what is done | motion [s] |", "|---|---|---|---|", *rows])


def tipping(jobs):
    """How two jobs on light bases end."""
    lines = ["| tipping rows | ends | least load on a base's edge | largest tilt |", "|---|---|---|---|"]
    for name, job in jobs.items():
        least = job.least_edge_load
        reason = f"{job.state}: {job.reason}" if job.reason else job.state
        lines.append(f"| {name} | {reason} | {least:.1f} N | {np.degrees(job.tilts.max()):.1f}° |")
    return "\n".join(lines)


def main():
    """Everything anew."""
    suspended, constrained = cl.load_world("fastkit_suspended"), cl.load_world("fastkit_constrained")
    jobs = {"suspended, torque control": pick_and_place(suspended),
            "suspended, velocity control": pick_and_place(suspended, control="velocity"),
            "constrained, torque control": pick_and_place(constrained),
            "constrained, velocity control": pick_and_place(constrained, control="velocity")}
    save_figure(plot_job(jobs["suspended, torque control"]), DOCS / "picking.png")
    info = PngInfo()
    info.add_itxt("Description", "Six pictures of FASTKIT's job: coupled, deploying, reaching, drawing in, carrying, "
                                 "pushing out.")
    strip(jobs["suspended, torque control"]).quantize(96).save(DOCS / "picking_frames.png", pnginfo=info, optimize=True)
    harder = {name: pick_and_place(light(constrained), control=TorqueControl(toward=STIFF, standing=standing))
              for name, standing in (("in the program", True), ("left out", False))}
    write_tables(DOCS / "picking.md",
                 {"phases": phases(suspended), "results": results(jobs), "tipping": tipping(harder)})


if __name__ == "__main__":
    main()
