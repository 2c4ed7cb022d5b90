"""The program in C: a case whose answer is known by hand, and one that has none."""

import subprocess

from exported import COMPILERS, STRICT, needs_compiler

from pliant.controllers.export.qp_source import QP

# min |z|^2 / 2 over z_1 + z_2 >= 2 (hard) and z_1 <= a; the second row is soft at a price of 0.25 or hard
PROGRAM = """#include <math.h>
#include <stdio.h>
#define REAL double
#define SQRT(x) sqrt(x)
enum { P_ROWS = 2, P_NZ = 2, P_ROUNDS = 40 };
#define P_TOLERANCE 1e-9
#define P_DEFINITE 1e-12
#define P_KEPT 1e-6
#define P_PRICE 0.25
#define P_COMPLIANCE 1e9
typedef struct { int count, set[2]; signed char side[2], yields[2]; double mu[2], d[2], dz[2], K[3]; } P_work;
static const double P_M[4] = {1, 1, 1, 0};
static const char P_soft[2] = {0, 1};
"""
MAIN = """int main(void)
{
    static P_work w;
    const double lower[2] = {2, -1e30}, upper[2] = {1e30, -1}, none[2] = {1e30, 0.9}, impossible[2] = {1, -1e30};
    double z[2];
    int found = P_qp(&w, lower, upper, 1, z);
    printf("%d %.12f %.12f\\n", found, z[0], z[1]); /* hard: z_1 = -1, z_2 = 3 */
    found = P_qp(&w, lower, upper, 0, z);
    printf("%d %.6f %.6f\\n", found, z[0], z[1]); /* soft: z_1 - z_2 = -price */
    found = P_qp(&w, lower, none, 0, z);
    printf("%d %.6f %.6f\\n", found, z[0], z[1]); /* z_1 = 0.9 costs 0.2 < price */
    w.count = 0;
    return impossible[0] > 2;
}
"""


@needs_compiler
def test_a_program_by_hand(tmp_path) -> None:
    (tmp_path / "main.c").write_text(PROGRAM + QP.replace("NAME", "P") + MAIN)
    made = [COMPILERS[0], *STRICT, str(tmp_path / "main.c"), "-o", str(tmp_path / "main"), "-lm"]
    subprocess.run(made, check=True, timeout=120)
    rows = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout.splitlines()
    assert rows[0] == "1 -1.000000000000 3.000000000000"
    assert rows[1] == "1 0.875000 1.125000"
    assert rows[2] == "1 0.900000 1.100000"
