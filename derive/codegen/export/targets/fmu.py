"""The C source of a functional mock-up unit, FMI 3.0: model exchange and co-simulation."""

from collections.abc import Sequence
from importlib import resources

from derive.codegen.export.targets.c99 import C99

#: Functions of the standard that this unit has no use for: of other types, clocks, and what its
#: description excludes. They report an error.
UNSUPPORTED = """
    InstantiateScheduledExecution ActivateModelPartition EnterConfigurationMode
    ExitConfigurationMode GetFloat32 GetInt8 GetUInt8 GetInt16 GetUInt16 GetInt32 GetUInt32
    GetInt64 GetUInt64 GetBoolean GetString GetBinary GetClock SetFloat32 SetInt8 SetUInt8
    SetInt16 SetUInt16 SetInt32 SetUInt32 SetInt64 SetUInt64 SetBoolean SetString SetBinary
    SetClock GetNumberOfVariableDependencies GetVariableDependencies SerializedFMUStateSize
    SerializeFMUState DeserializeFMUState GetDirectionalDerivative GetAdjointDerivative
    GetOutputDerivatives GetIntervalDecimal GetIntervalFraction GetShiftDecimal GetShiftFraction
    SetIntervalDecimal SetIntervalFraction SetShiftDecimal SetShiftFraction
""".split()
#: Before the functions of the simulation, which report events by print_row().
EVENTS = """\
#if defined _MSC_VER
#define THREAD __declspec(thread)
#else
#define THREAD __thread
#endif

/* The first event of a step of co-simulation that is later than another time, one a thread. */
static THREAD double first_event, earliest_event;
"""
PRINT_ROW = """
static void print_row(double t, const double *values)
{
    (void)values;
    if (t > earliest_event && t < first_event) {
        first_event = t;
    }
}
"""
#: Functions that have nothing to do.
TRIVIAL = """
    SetDebugLogging EnterInitializationMode EnterEventMode Terminate EnterContinuousTimeMode
    EnterStepMode EvaluateDiscreteStates
""".split()


class Unit(C99):
    """The functions of the standard around those of a simulation."""

    title, suffix, has_libraries = "FMI 3.0 functional mock-up unit", ".c", False
    command, is_program, entry = "", False, ("advance", "row")
    has_events, qualifiers = True, "static inline"

    def guard(self) -> str:
        return ""

    def head(self) -> str:
        return super().head() + EVENTS + (PRINT_ROW if self.exported.event else "")

    def tail(self) -> str:
        of, n = self.exported, len(self.exported.start)
        state: list[str] = []
        for k in range(n):
            state += [f"sin(v[{k}])", f"cos(v[{k}])"] if k in of.angles else [f"v[{k}]"]
        lines = [f"    y[{place}] = {text};" for place, text in enumerate(state)]
        lines += [f"    angles[{a}] = v[{k}];" for a, k in enumerate(of.angles)]
        others = [f"FMI int fmi3{name}(void) {{ return 3; }}" for name in UNSUPPORTED]
        others += [f"FMI int fmi3{name}(void) {{ return 0; }}" for name in TRIVIAL]
        constant = "static const double {}{} = {};"
        event, at = of.event or (0, 0.0)
        return "\n".join(
            [
                f"enum {{ STATES = {n}, PARAMETERS = {len(of.values)} }};",
                f"enum {{ ANGLES = {max(len(of.angles), 1)} }};",
                f"#define ANGLES_OF(one) {'one->angles,' if of.angles else ''}",
                f"enum {{ EVENTS = {int(of.event is not None)}, EVENT_VALUE = {event} }};",
                constant.format("EVENT_AT", "", self.literal(at)),
                constant.format("START_VALUES", "[]", self._list(of.start)),
                constant.format("DEFAULT_PARAMETERS", "[]", self._list(of.values)),
                "",
                "static void to_state(const double *v, double *y, double *angles) {",
                *lines,
                "    (void)angles;",
                "}",
                "",
                resources.files("derive.codegen.export").joinpath("fmi3.c").read_text("utf-8"),
                *others,
            ]
        )

    def _list(self, values: Sequence[float]) -> str:
        return f"{{{', '.join(map(self.literal, values))}}}"


target = Unit
