"""Returns at which a scene counts as solved: of the reward "cost", from the scene's own start, nothing drawn.

What LQR returns in the scoreboard's exact case (docs/scoreboard), MPC where LQR leaves the bounds, less one percent.
None for slider-crank-run, where doing nothing returns that already. The normalised reward has another scale: its return
is at most the number of periods.
"""

THRESHOLDS = {
    "single-link-slew": -3.546,
    "single-link-slew-gentle": -3.685,
    "two-link-reach": -2.507,
    "two-link-reach-weak": -2.969,
    "cantilever-drop": -10.72,
    "spin-up": -106.4,
    "flexible-joint-slew": -2.732,
    "crane-swing": -12.55,
    "six-axis-pick": -10.64,
    "three-link-flexible": -4.138,
    "satellite-arm": -40.79,
    "spacecraft-slew": -22.50,
    "spacecraft-wheels": -9.689,
    "spacecraft-spin": -1.830,
    "spacecraft-orbit": -4.924,
}
