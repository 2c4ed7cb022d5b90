"""What people run: the speed-accuracy chart, the choice of a model, closed loops and the report."""

if __name__ != "pliant.studies":
    raise ImportError("this folder is installed as pliant.studies: write `import pliant.studies`")

from typing import TYPE_CHECKING

from pliant.plants.core import imports

if TYPE_CHECKING:  # imported when they are first asked for: see below
    from pliant.studies.charts.gallery import gallery
    from pliant.studies.charts.measure import chart
    from pliant.studies.common.progress_bar import progress_bar
    from pliant.studies.fidelity.choice import choose
    from pliant.studies.monte_carlo.monte_carlo import monte_carlo
    from pliant.studies.report.report import report
    from pliant.studies.robust.robustify import robustify
    from pliant.studies.scoreboard.scoreboard import scoreboard

__all__ = ["chart", "choose", "gallery", "monte_carlo", "progress_bar", "report", "robustify", "scoreboard"]

imports.offer(
    __name__,
    {
        "charts.gallery": "gallery",
        "charts.measure": "chart",
        "common.progress_bar": "progress_bar",
        "fidelity.choice": "choose",
        "monte_carlo.monte_carlo": "monte_carlo",
        "report.report": "report",
        "robust.robustify": "robustify",
        "scoreboard.scoreboard": "scoreboard",
    },
)
imports.serve(
    __name__,
    {
        "common": "files=atomic_files machine motions=reference_motions points=operating_point markup=formatting",
        "closed_loop": "rollout played=evaluation_scene scores contestants comparison bound=optimal_bound",
        "fidelity": "chart=speed_accuracy stiffening mode_count",
        "figures": "style shapes=arm_outline figures_models=linear_models figures_chart=speed_accuracy "
        "figures_control=controllers figures_space=motion stability_figures=stability "
        "scoreboard_figures=scoreboard",
        "papers": "paper_figures=registry single_link_figures=single_link large_beam_figures=large_beam "
        "slider_crank_figures=slider_crank",
        "stability": "stability_map=parameter_map judgement stability_command=verdicts",
        "report": "page sections sections_control=control_sections tables=json_tables",
        "scoreboard": "scoreboard_work=tasks scoreboard_table=tables",
        "commands": "cli console scoreboard_command=scoreboard doctor train",
    },
)
