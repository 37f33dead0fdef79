"""Automatic train control of 1961: words that claims decide, words that relations decide, and slips in names.

What only says what something is good for is not derivable; so are principles without a number or a direction.
Source: words as the specification reports them [P]; relations [D]; decelerations, cycles, times of the models [A].

Main results: marker 2 where the standard curve meets the top speed is not sufficient; two figures are cited by wrong
numbers; continuous control and acknowledgement hold in the models as they are described.
"""

from __future__ import annotations

from proofs.atc_1961_figures import paper

MARKERS, LIMITER, PROGRAM = "section 3.1.1", "section 3.2", "section 4.2"
for _name, _unit, _about, _by in (
    ("free", "m", "way of the free run", "V*t"),
    ("stop", "m", "stopping distance", "V*t + V^2/(2*b)"),
    ("spacing", "m", "from marker 2 to marker 3", "V*t + (V^2 - V1^2)/(2*(b - g*p))"),
    ("pulse_way", "m", "between two crossings of the conductor", ""),
    ("T_0", "s", "base interval of the pulses", ""),
    ("interval", "s", "measured between two pulses", "pulse_way/V"),
    ("worth", "1", "what a method is worth", ""),
    ("worth_before", "1", "what there was before", ""),
):
    paper.symbol(_name, _unit, _about, by=_by)

# --- decided by claims -----------------------------------------------------------------------------------------------

GENERATOR, SOVIET = "section 3.1.2, brake-start control", "section 2.3, figure 4"
for _requirement, _name, _text, _where, _claim in (
    ("SP-F1", "magnet.stops", "the magnet acts unless the clearing coil is energised: loss of supply stops the train",
     "section 2.1, permanent magnets", "transmission.magnet_stops_who_passes"),
    ("SP-F1", "resonance.stops", "at stop the track coil resonates, the impulse relay drops and the brake acts",
     "section 2.1, resonant coils", "transmission.resonance_stops_who_passes"),
    ("SP-H1", "continuous.loss", "loss of the coded current is the most restrictive indication", "section 2.2",
     "transmission.loss_takes_the_limit_to_zero"),
    ("SP-C1", "continuous.acts", "a change of the indication acts at once on a train anywhere in the section",
     "section 2.2", "transmission.restriction_acts_within_detection"),
    ("SP-G1", "gradient.strong", "with 5 curves the scatter is about +-25 m, read: with 3.4374 km/h/s or more",
     GENERATOR, "function_generator.brake_once_stops_near_the_curve"),
    ("SP-G1", "gradient.weak", "with 5 curves the scatter is about +-25 m, read: with 3.0 km/h/s too",
     GENERATOR, "function_generator.brake_once_stops_near_the_curve_at_3_kmh_s"),
    ("SP-M1", "soviet.stopped", "limits of 40, 25, 15 km/h, and the train stands at D", SOVIET,
     "point_continuous.train_stands_at_the_signal"),
    ("SP-C1", "soviet.continuous", "the continuous control bounds what a missing inductor lets through", SOVIET,
     "point_continuous.channel_bounds_a_missing_inductor"),
    ("SP-F1", "american.acknowledgement", "without acknowledgement the emergency brake is applied", "section 2.2",
     "code_control.silence_brings_the_emergency_brake"),
    ("SP-F1", "american.limit", "beyond the B point 15 mph is the limit: faster trains are braked", "section 2.2",
     "code_control.brakes_above_the_limit_shown"),
):  # fmt: skip
    paper.under(_requirement).decided(_name, _text, where=_where, claim=f"patterns_{_claim}")
paper.under("SP-M1").decided(
    "markers.point_4", "passing 4 without an acknowledged stop brings the emergency brake", where=MARKERS,
    claim="patterns_markers.emergency_brake_comes_at_4",
)  # fmt: skip
paper.under("SP-M1").decided(
    "markers.drawn", "point 2 where the standard curve meets the top speed: nobody passes the signal", where=MARKERS,
    claim="patterns_markers.no_train_passes_the_signal_as_drawn",
)  # fmt: skip
for _requirement, _name, _text, _where, _claim in (
    ("SP-X2", "resonance.fails", "the resonant coil may fail to act", "section 2.1, resonant coils",
     "track_coil_that_fails_is_detected_at_once"),
    ("SP-F1", "trip_stop.fast", "the mechanical trip stop cannot work at high speed", "section 2.1, trip stop",
     "arm_stops_who_passes"),
):  # fmt: skip
    paper.under(_requirement).decided(_name, _text, where=_where, claim=f"patterns_transmission.{_claim}", denies=True)

# --- decided by relations --------------------------------------------------------------------------------------------

paper.wording("markers.gradient", "markers are laid further apart on a downgrade", where=MARKERS,
              says="spacing rises with p", when=("V > V1", "b > g*p"))  # fmt: skip
paper.wording("limiter.delay", "the delay is to be kept short: it lengthens the way to the stop", where=LIMITER,
              says="stop rises with t")  # fmt: skip
paper.wording("limiter.build_up", "scatter of the build-up time appears as scatter of the free run", where=LIMITER,
              says="free rises with t")  # fmt: skip
paper.wording("limiter.reading", "the speed is to be read with high precision: the way to the stop rises with it",
              where=LIMITER, says="stop rises with V")  # fmt: skip
paper.rule("pulses.power", "interval > T_0", where="section 2.4, figure 5: power when the pulses come too slowly",
           iff="V < pulse_way/T_0")  # fmt: skip
paper.rule("pulses.brake", "interval < T_0", where="section 2.4, figure 5: brake when they come too fast",
           iff="V > pulse_way/T_0")  # fmt: skip

# --- names -----------------------------------------------------------------------------------------------------------

FIGURES = {
    "Fig. 12": "the stepped limiter",
    "Fig. 17": "the receiver",
    "Fig. 18": "another drawing: figures are numbered through",
    "Fig. 20": "the on-board program",
}
paper.named("figure.receiver", "Fig. 12", where="text on the receiver", means="the receiver", names=FIGURES)
paper.named("figure.program", "Fig. 18", where=f"{PROGRAM}, text", means="the on-board program", names=FIGURES)
paper.named("word.distance_run", "走行料", where="text", means="distance run", names={"走行量": "distance run"})

# --- what nothing in print decides -----------------------------------------------------------------------------------

for _name, _text, _where in (
    ("aims", "safety, less skill of the driver, shorter headway, running times kept, less energy", "aims"),
    ("trip_stop", "the mechanical trip stop wears fast", "section 2.1"),
    ("resonance", "the resonant coil may act wrongly", "section 2.1"),
    (
        "limiter",
        "deceleration cannot be uniform: each speed step selects its service and emergency brake force",
        LIMITER,
    ),
    ("voltage", "taps make the motor voltage discontinuous", PROGRAM),
    ("correction", "time lag and speed error give a correction that is added to the voltage program", PROGRAM),
    (
        "soviet_program",
        "running-mode, time and limit programs with the track profile solve the equation of motion",
        "section 2.5",
    ),
):
    paper.statement(f"worth.{_name}", _text, where=_where, holds="worth > worth_before")
