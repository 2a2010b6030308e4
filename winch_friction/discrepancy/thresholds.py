"""Every constant by which the workflow decides, with its unit and its reason."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Thresholds:
    """Where a line of comment names the gap campaign, `make campaign-gap` on null data is what calibrates the value."""

    # -- adequacy, before anything is searched
    shortest_record: float = 5.0  # s; shorter than one hoist and lower
    lowest_rate: float = 5.0  # Hz; acceleration and reversals are lost below two samples per smoothing time
    least_usable: float = 20.0  # s of records: a few times what one speed takes
    least_moving: float = 15.0  # s of training samples that move, away from reversals
    least_each_way: float = 3.0  # s hoisting and lowering: one way alone, load and friction are one
    least_locked: float = 4.0  # s that move in what is locked: twenty blocks
    least_speed_spread: float = 1.3  # decile ratio; at one speed every loss is a constant
    # s of one run of heave compensation in which no swing could be told: what it began with has died by then, three
    # decay times of a rope's lightest damping (ratio 0.02) at the slowest mode (2.5 rad/s)
    swing_told: float = 60.0
    least_share_moving: float = 0.0  # said, not asked for: a long idle log may hold enough
    # -- blocks and segments
    block_time: float = 0.2  # s: the fast noise averages out, friction does not
    fullest_block: float = 0.6  # share of a block's samples that must be usable
    segments_wanted: int = 100  # enough for sign flips at 0.1 %
    longest_segment: float = 20.0  # s; longer would leave too few segments
    shortest_segment: float = 1.0  # s; shorter ones are not independent of their neighbours
    # -- noise
    noise_window: int = 12  # blocks; a parabola over two seconds follows any friction, load or wave
    noise_order: int = 2  # of the polynomial that is taken out
    noise_quiet: float = 0.25  # quantile: the quieter windows speak, in the others an oscillation may ring down
    noise_floor: float = 1e-2  # of what no balance closes: below it a record is as good as noise-free
    # -- the base model's freedom
    prior_bound: float = 2.0  # sigma; a base parameter beyond it is itself a finding
    prior_weight: float = 10.0  # blocks per independent one: correlated noise makes the data count for less (campaign)
    default_relative_std: float = 0.2  # of a parameter of a model without covariance
    bare: int = 3  # parameters up to which a model is bare: of what it lacks any size is believed
    unbounded: float = 1e9  # typical sizes: what a bare model's plain terms may have
    least_noise: float = 0.1  # bar; less than what a 12-bit transducer of 600 bar steps by, which is 0.15
    step: float = 1.5  # times it: that step, up to which a zero is off without being wrong
    # of what hangs there, that a load cell differs by from run to run beside the one tolerance for all of them: what
    # the best cells repeat to; of ten runs that were off by so much a feedback "shifted with the oil"
    least_share_of_load: float = 3e-4
    least_share_of_torque: float = 1e-3  # of an electric drive's torque under the rated load, of which it is stated
    bare_room: float = 10.0  # times the size found: how far a bare model's new parameter may move later
    # -- folds and evidence
    fewest_runs: int = 5  # with fewer, folds are stretches of time
    folds: int = 8  # of stretches
    flips: int = 2000  # sign flips: p-values down to 0.0005
    # family-wise significance that a gain in held-out RMSE from so much on must have: the smaller it is the surer, for
    # a fading warmth shows in few segments, but a large gain is not chance (campaign)
    significance: tuple[tuple[float, float], ...] = ((0.1, 0.05), (0.02, 0.01), (0.01, 0.001))
    least_inside: float = 2e-3  # of the RMSE on the runs it is fitted to, where the base takes a part of every effect
    least_share: float = 1e-3  # of what is explained already: less is the first effect's own second order
    most_effects: int = 4  # more at once imitate anything
    rival_p: float = 0.05  # a rival is worse only where segments say so this surely
    rival_share: float = 0.03  # of the effect's own gain: a rival within it does as well for any purpose
    rival_worth: float = 0.5  # of the effect's own gain that a rival must reach to be considered
    looked_at_closer: int = 4  # rivals whose shapes are refined like that of what was found
    most_names: int = 3  # in a set, which is no answer where it leaves out more than those
    free_charge: float = 0.05  # of what a flexible member saves, that a law of the literature may save less
    plain_first: float = 1e-3  # of what is saved: of laws that do the same, the one that every machine has
    grammar_heads: int = 6  # single factors that are tried together with every other
    grammar_judged: int = 12  # laws of one and of two factors whose held-out loss is looked at
    proposal_gain: float = 0.3  # of the gap's square above the noise that a law must close, on locked runs too
    proposal_share: float = 0.8  # of what the best law closes: simpler ones that do nearly as well come first
    closes_nearly_all: float = 0.9  # of the locked gap above the noise: then an equation, and no seed, is what is off
    word_price: float = 0.05  # of the logarithm of the loss, per word and constant: a simpler law may leave 5 % more
    as_good: float = 0.25  # of the same logarithm, within which another law is worth showing beside the best
    most_proposals: int = 3
    proposals_tried: int = 4  # on the locked runs, 1.6 s each: of 40 effects two had their first after a refusal or two
    tuning_rounds: int = 3  # halving steps between the grid's constants
    free_knots: tuple[float, ...] = (0.02, 0.25, 0.5, 0.75, 0.98)  # quantiles of a signal between which it may bend
    stribeck_knots: tuple[float, ...] = (0.02, 0.06, 0.12, 0.2, 0.35)  # it is over within the slower third
    surface_knots: tuple[float, ...] = (0.02, 0.35, 0.65, 0.98)  # the same along each of two signals
    # of what was covered: loads that are the same but for their cell, or a slope over next to nothing is the next run's
    knots_apart: float = 0.02
    resolved: float = 0.01  # of the largest value: what sensors of pressure, stroke, speed and load tell apart
    stiffness: float = 0.01  # of what the data know of an interval of a curve, that speaks against a change of slope
    law_accuracy: float = 0.1  # of itself: what the literature's laws of losses are good for on another machine
    near_the_floor: float = 3.0  # times it: what an inexact law may leave; more is seen by whoever looks at the runs
    outdone: float = 0.5  # of what a name leaves, that a law which is not its own may leave for it to fall; and of what
    # a law leaves, that a curve of the same cause may leave to speak for it
    surely_outdone: float = 0.1  # of what a name leaves: less is left by no law that only picks the right runs
    # -- the seed's claim
    seed_reach: float = 4.5  # stated deviations that the base may move while its prior is on trial
    seed_sigma: float = 3.3  # joint surprise, deviations of a normal variable: one seed in a thousand
    seed_marginal: float = 2.5  # the same for one parameter
    told: float = 0.3  # share of its prior variance that the data must take off a direction to have a say in it
    as_much: float = 1.05  # times the excess that the names leave, which the freed base may leave beside them
    ordinary_shift: float = 4.0  # stated deviations: further off it is more likely an effect than a careless seed
    effect_price: float = 12.0  # twice the log-likelihood that a name must be worth: one of sixty, and its size
    # of the excess just after reversals that an effect must explain: over drawn cranes true ones did 0.35 to 0.97,
    # air in the oil, which none of them is, 0.24
    reversal_share: float = 0.33
    # deviations between two levels of so many runs or more: of runs that are spread somehow (normal, evenly,
    # exponentially, whatever hangs there) hardly 1 in a hundred, of six 3, seem to make two levels so far apart
    levels_apart: tuple[tuple[int, float], ...] = ((10, 9.0), (8, 10.0), (6, 14.0))
    # of a level's stated deviation, that runs of one level may differ by although these do not: the deviation allows
    # for noise that is correlated over `prior_weight` blocks, and where the runs agree more closely than that it is not
    levels_surer: float = 0.35
    other_level: float = 0.2  # of what lies between two levels, above which the one nearer to zero counts as well
    fewest_levels: int = 6  # runs, for two levels to be told
    # of the variance of the runs' levels: a signal, or the date, that leaves less tells them. Of amounts that are drawn
    # at random over the runs of drawn cranes 5 in a hundred seem to follow one of seven signals (15 at 0.35), and of
    # what follows one by a law that is not asked, beside a tenth of noise, 94 do
    followed: float = 0.25
    # of the variance of a length over the layers: where the layer leaves less the two are one
    told_by_signal: float = 0.35
    # -- remainder
    knots: int = 7  # of the flexible model of one signal
    ridge: float = 30.0  # blocks; a hat needs more data than that before it moves
    remainder_p: float = 0.01  # family-wise, for a signal that predicts what is left
    # of the load, that a load cell may be off by, from run to run: twice what pins in sheaves are stated with (1 %)
    most_level: float = 0.02
    level_p: float = 0.01  # family-wise, for a mean or a signal that tells such levels: then they are a cause's
    # -- verdict
    least_unexplained: float = 0.08  # share of the remainder that one signal must predict when no effect was found
    left_over: float = 0.15  # share of the excess over the noise floor that a named effect may leave
    least_excess: float = 0.35  # of the noise variance: less than that above the floor is nobody's effect
    obvious_excess: float = 1.5  # of the noise variance: needs no signal to point at it
    never_noise: float = 3.0  # of the noise variance: twice the noise is something, predicted or not
    large_excess: float = 2.0  # of the noise variance, from where on a smaller share counts ...
    small_left_over: float = 0.04  # ... namely this one
    steady: float = 0.03  # share of the largest acceleration below which nothing swings or rings
    fewest_steady: int = 300  # blocks; with fewer all count
    most_named: int = 2  # effects besides the plain terms of a bare model
    most_signals: int = 3  # named in 'unexplained'
    least_named_share: float = 0.02  # of the remainder, that a signal must predict to be named before others
    # -- locked runs
    fewest_to_lock_whole: int = 4  # runs; with fewer, the end of every run is locked instead
    lock_draws: int = 200  # of locked runs, of which the one is taken that reaches least beyond the others
    lock_cover: float = 0.03  # weight of what the locked runs cover, beside that of what they reach beyond the others
    lock_range: tuple[float, float] = (0.05, 0.95)  # quantiles of a signal between which a run covers it
    guard_time: float = 0.5  # s between the two parts of a divided run
    bootstrap_draws: int = 1000  # of segments, for an interval
    runs_to_redraw: int = 8  # locked runs, from which on runs are redrawn and not only their segments
    interval: tuple[float, float] = (0.025, 0.975)  # a 95 % interval
    proof_p: float = 0.025  # chance that the named effects gain nothing on the locked runs beside a mere refit
    # of what any balance closes, that a name must take off the locked gap of a refit that is at its floor: a null,
    # whose thermal zero "bent" by a third of its deviation, gained 0.034 bar
    beside_a_refit: float = 0.5
    # share of the excess of a mere refit of the locked runs, that names may leave where it is more than noise:
    # right ones under laws that are not theirs leave up to a half, a wrong one of a log at 10 Hz left 0.96
    left_beside_a_refit: float = 0.7
    worse_p: float = 0.005  # chance that a locked run which seems worse is not, shared among the runs
    worse: float = 1.1  # times its former gap: a run that grows by less is as before
    at_the_floor: float = (
        1.5  # times the floor (noise and what no balance closes) that nothing missing may leave (campaign)
    )
    in_step: float = 0.5  # of a sample's time, by which the signals of one log may be off without being late
    # times the floor, that several names may leave: true pairs leave 0.9 to 1.15, wrong second names to 3.4 (campaign)
    several_leave: float = 1.3
    # of what several names explain, that is no inexactness of the others: laws of the literature that are not a
    # machine's own leave a tenth of the torque, a hundredth of its square, and bad ones a tenth of it
    large_part: float = 0.2
    far_off_the_floor: float = 2.0  # times the floor: more is something, however few segments show it
    # times what names leave of the training runs, each beside its floor: that and more of the locked runs is left by
    # what fits the runs that it was chosen on and no others. Right names left up to 2.1 times as much, over ten draws
    chosen_on: float = 2.5
    # of the blocks by speed, and at least so many, that are looked at by themselves: a fifteenth of a wave is slower
    # than 230 rpm, and what acts there alone, some bar, is next to nothing of all of it
    slowest: float = 0.1
    fewest_slowest: int = 100
    # times the floor, that these may keep where nothing is missing: of 70 nulls at most 1.13, of break-aways that were
    # missed 1.4 to 2.6
    slowest_left: float = 1.25
    # -- regions
    most_regions: int = 3
    smallest_region: float = 0.03  # of the blocks
    single_condition: float = 0.8  # of the best pair's score that one condition needs: shorter words win
    # -- refinement
    most_expansions: int = 2  # preparations around what was found; a third changes nothing (campaign)
    shape_std: float = 0.1  # relative; a shape is chosen from a grid
    polishing: int = 10  # Gauss-Newton steps on the repaired model itself at most; few are ever worth taking
    worth_polishing: float = 0.999  # of the misfit: a step that does not get below it is not taken
    loosened: float = 10.0  # times its first deviation: what was just found is fitted freely
    # -- next experiment
    enough_separation: float = 3.0  # standard deviations that tell two effects apart


LIMITS = Thresholds()
