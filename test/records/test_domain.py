"""A domain of one's own: tests, benchmarks and demos run beside each other on one machine."""

import os
import random
import subprocess
import sys

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.records.domain import DOMAINS, unused_domain

THERE = "import rclpy; rclpy.init(); node = rclpy.create_node('there'); print('there', flush=True); input()"


def test_a_domain_that_another_process_is_in_is_not_taken(monkeypatch):
    taken = unused_domain()
    monkeypatch.setattr(random, "sample", lambda domains, count: [taken, *(each for each in domains if each != taken)])
    assert unused_domain() == taken
    environment = {**os.environ, "ROS_DOMAIN_ID": str(taken)}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", THERE], env=environment, text=True, **pipes) as process:
        assert process.stdout.readline() == "there\n"
        assert unused_domain() != taken
        process.communicate("\n")


def test_it_is_one_that_every_system_can_use():
    assert {unused_domain() for _ in range(5)} <= set(DOMAINS)
    assert (DOMAINS.start, DOMAINS.stop - 1) == (1, 101)
