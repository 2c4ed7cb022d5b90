"""The program in C: cases whose answers are known by hand, and one that has none."""

import subprocess

from exported import COMPILERS, STRICT, needs_compiler

from pliant.controllers.export.qp_source import PROGRAM, QP

# min |z|^2 / 2 over z_1 + z_2 >= 2 (hard) and z_1 <= a, soft at a price of 0.25 or hard; a third row -z_1 - z_2 >= b
START = """#include <math.h>
#include <stdio.h>
#define REAL double
#define SQRT(x) sqrt(x)
#define P_TOLERANCE 1e-9
#define P_DEFINITE 1e-12
#define P_KEPT 1e-6
typedef struct { int count, known, set[3]; signed char side[3], yields[3]; double mu[3], d[3], dz[2], K[6]; } P_work;
static const double P_M[6] = {1, 1, 1, 0, -1, -1};
static const char P_soft[3] = {0, 1, 0};
"""
MAIN = """int main(void)
{
    static P_work w;
    const P_program q = {3, 2, P_M, P_soft, 0.25, 1e9};
    const double lower[3] = {2, -1e30, -1e30}, upper[3] = {1e30, -1, 1e30}, none[3] = {1e30, 0.9, 1e30};
    const double against[3] = {2, -1e30, -1};
    double z[2];
    int found = P_qp(&w, &q, lower, upper, 1, z);
    printf("%d %.12f %.12f\\n", found, z[0], z[1]); /* hard: z_1 = -1, z_2 = 3 */
    found = P_qp(&w, &q, lower, upper, 0, z);
    printf("%d %.6f %.6f\\n", found, z[0], z[1]); /* soft: z_1 - z_2 = -price */
    found = P_qp(&w, &q, lower, none, 0, z);
    printf("%d %.6f %.6f\\n", found, z[0], z[1]); /* z_1 = 0.9 costs 0.2 < price */
    found = P_qp(&w, &q, against, upper, 1, z);
    printf("%d\\n", found); /* z_1 + z_2 <= 1 too: no z */
    found = P_qp(&w, &q, against, none, 0, z);
    printf("%d\\n", found); /* nor where the second row may yield */
    return 0;
}
"""


@needs_compiler
def test_a_program_by_hand(tmp_path) -> None:
    (tmp_path / "main.c").write_text(START + (PROGRAM + QP).replace("NAME", "P") + MAIN)
    made = [COMPILERS[0], *STRICT, str(tmp_path / "main.c"), "-o", str(tmp_path / "main"), "-lm"]
    subprocess.run(made, check=True, timeout=120)
    rows = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout.splitlines()
    assert rows[0] == "1 -1.000000000000 3.000000000000"
    assert rows[1] == "1 0.875000 1.125000"
    assert rows[2] == "1 0.900000 1.100000"
    assert rows[3:] == ["0", "0"]
