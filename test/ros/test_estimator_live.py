"""An estimator over DDS whose speed falls silent, and one that is ended."""

import signal

from dds_bench import Bench

from winch_friction.online.compensator import read_mark


def test_the_estimators_torque_stands_neither_in_a_silence_nor_after_the_end(bench: Bench) -> None:
    """388 N m stood for as long as nothing came, and after SIGTERM for ever."""
    bench.start("estimator")
    learned = bench.listen("estimator/friction_torque")
    bench.announce()
    for _ in range(2):
        bench.drive(1.0)
        assert abs(learned[-1].effort[0]) > 50.0
        assert bench.spin(2.0, lambda: learned[-1].effort[0] == 0.0)
        # of the last torque: on a busy machine some are still on their way when the driving ends
        number = read_mark([each for each in learned if each.effort[0] != 0.0][-1].header.frame_id)[1]
        assert read_mark(learned[-1].header.frame_id) == (False, number + 1)
        bench.spin(0.5)
        assert read_mark(learned[-1].header.frame_id) == (False, number + 1)  # said once
        bench.time += 1.0
    bench.drive(1.0)
    assert abs(learned[-1].effort[0]) > 50.0
    bench.processes["estimator"].send_signal(signal.SIGTERM)
    assert bench.spin(3.0, lambda: learned[-1].effort[0] == 0.0)
    assert bench.processes["estimator"].wait(5.0) == 0
