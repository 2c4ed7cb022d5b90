"""The clock of limits goes with work, not with time."""

import subprocess
import sys
import time

from pliant.studies.common.processor_time import processor_time


def test_it_stands_still_where_nothing_is_done():
    began = processor_time()
    time.sleep(0.3)
    assert processor_time() - began < 0.1


def test_it_goes_on_with_work_and_with_programs_that_were_waited_for():
    began, until = processor_time(), time.thread_time() + 0.05
    while time.thread_time() < until:
        pass
    alone = processor_time() - began
    assert 0.05 <= alone < 0.1
    subprocess.run([sys.executable, "-S", "-c", "for _ in range(3_000_000): pass"], check=True)
    assert processor_time() - began > alone + 0.02
