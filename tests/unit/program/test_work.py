import pytest

from trochia.program import SYSTEMS, WorkState


def test_a_work_state_without_offsets():
    work = WorkState()
    assert work.active == 1
    assert len(work.systems) == len(SYSTEMS) == 9
    assert not work.g92_on


def test_placing_is_only_for_the_active_system():
    work = WorkState(active=2).placed(X=1.0, C=90.0)
    assert work.systems[0] == (0.0,) * 9
    assert work.systems[1] == (1.0, 0.0, 0.0, 0.0, 0.0, 90.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"active": 0}, "active"),
        ({"active": 10}, "active"),
        ({"systems": ((0.0,) * 9,)}, "systems"),
        ({"rotations": (0.0,)}, "rotations"),
        ({"g28": (0.0,) * 3}, "g28"),
        ({"systems": ((0.0,) * 8, *((0.0,) * 9,) * 8)}, "G54"),
    ],
)
def test_a_wrong_shape_is_named(wrong, named):
    with pytest.raises(ValueError, match=named):
        WorkState(**wrong)
