# What type checkers and editors see of the lazily loaded surface; a test holds it against __init__.py.
from winch_friction import terms as terms
from winch_friction.api.evaluate import contributions as contributions
from winch_friction.api.evaluate import friction_curve as friction_curve
from winch_friction.api.evaluate import jacobian as jacobian
from winch_friction.api.evaluate import torque as torque
from winch_friction.api.files import load_crane as load_crane
from winch_friction.api.files import load_model as load_model
from winch_friction.api.files import save_model as save_model
from winch_friction.api.runs import from_frame as from_frame
from winch_friction.api.runs import read_run as read_run
from winch_friction.api.runs import write_run as write_run
from winch_friction.api.work import check as check
from winch_friction.api.work import fit as fit
from winch_friction.api.work import gap as gap
from winch_friction.api.work import replay as replay
from winch_friction.api.work import simulate as simulate
from winch_friction.compensation import FeedforwardCompensator as FeedforwardCompensator
from winch_friction.estimation import FrictionEstimator as FrictionEstimator
from winch_friction.physics.errors import InputError as InputError
from winch_friction.physics.friction.model import FrictionModel as FrictionModel
from winch_friction.physics.signals import GroupSample as GroupSample
from winch_friction.physics.signals import Run as Run
from winch_friction.physics.signals import Sample as Sample
from winch_friction.physics.winch.crane import Crane as Crane

__version__: str
__all__: list[str]
