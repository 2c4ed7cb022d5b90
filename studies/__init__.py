"""What people run: the speed-accuracy chart, the choice of a model, closed loops and the report."""

if __name__ != "pliant.studies":
    raise ImportError("this folder is installed as pliant.studies: write `import pliant.studies`")

# Eager, because these functions share the names of their modules: a later import would put the module
# in their place. The modules themselves import what draws only where they draw.
from .chart import chart
from .fidelity import choose
from .report import report
from .scoreboard import scoreboard

__all__ = ["chart", "choose", "report", "scoreboard"]
