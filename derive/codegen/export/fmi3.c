/* The functions of FMI 3.0 around those of a simulation: model exchange and co-simulation.

   Defined before: STATES, ANGLES, SIZE and PARAMETERS, START_VALUES and DEFAULT_PARAMETERS, rhs(),
   row() and advance(); to_state(), which computes the state of the equations from coordinates and
   velocities; ANGLES_OF(one), the argument of angles if there are any; first_event and
   earliest_event, and of an event (EVENTS is 1, not 0) the number of its value and that value. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined _WIN32
#define FMI __declspec(dllexport)
#else
#define FMI
#endif

/* Value references: 0 is the time, then coordinates and velocities, the energy, the derivatives
   of coordinates and velocities, the indicator of an event, and the parameters and inputs. */
enum { FIRST_DERIVATIVE = STATES + 2, FIRST_PARAMETER = 2*STATES + 2 + EVENTS };
/* The part of a step that has no second event after a step that ended at one. */
#define SEPARATION 1e-9

typedef struct {
    double t, h;
    double values[STATES + 1]; /* coordinates, velocities, energy */
    double y[SIZE], angles[ANGLES], params[PARAMETERS];
    bool is_changed; /* whether the state y has to follow the values */
    bool ends_steps_at_events;
    double last_event;
} Instance;

/* The state of the equations from coordinates and velocities. */
static void follow_values(Instance *one)
{
    to_state(one->values, one->y, one->angles);
    one->is_changed = false;
}

static void evaluate(Instance *one)
{
    if (one->is_changed) {
        follow_values(one);
    }
    row(one->t, one->y, ANGLES_OF(one) one->params, one->values);
}

FMI int fmi3Reset(Instance *one)
{
    *one = (Instance){.ends_steps_at_events = one->ends_steps_at_events, .last_event = NAN};
    memcpy(one->values, START_VALUES, STATES*sizeof(double));
    memcpy(one->params, DEFAULT_PARAMETERS, PARAMETERS*sizeof(double));
    follow_values(one);
    return 0;
}

FMI const char *fmi3GetVersion(void) { return "3.0"; }

FMI void *fmi3InstantiateModelExchange(void)
{
    Instance *one = calloc(1, sizeof(Instance));
    if (one) {
        fmi3Reset(one);
    }
    return one;
}

FMI void *fmi3InstantiateCoSimulation(
    const char *name, const char *token, const char *path, bool is_visible, bool has_log,
    bool has_event_mode, bool permits_early_return)
{
    (void)name, (void)token, (void)path, (void)is_visible, (void)has_log;
    Instance *one = fmi3InstantiateModelExchange();
    if (one) {
        one->ends_steps_at_events = has_event_mode && permits_early_return;
    }
    return one;
}

FMI void fmi3FreeInstance(Instance *one) { free(one); }
FMI int fmi3ExitInitializationMode(Instance *one) { follow_values(one); return 0; }

FMI int fmi3GetFloat64(Instance *one, const uint32_t *references, size_t count, double *values)
{
    double rate[SIZE];
    evaluate(one);
    rhs(one->t, one->y, one->params, rate);
    for (size_t k = 0; k < count; k++) {
        const int r = (int)references[k], d = r - FIRST_DERIVATIVE, p = r - FIRST_PARAMETER;
        if (r == 0) {
            values[k] = one->t;
        } else if (d < 0) {
            values[k] = one->values[r - 1];
        } else if (d < STATES) {
            values[k] = d < STATES/2 ? one->values[STATES/2 + d] : rate[SIZE - STATES + d];
        } else if (p < 0) {
            values[k] = one->values[EVENT_VALUE] - EVENT_AT;
        } else if (p < PARAMETERS) {
            values[k] = one->params[p];
        } else {
            return 3;
        }
    }
    return 0;
}

FMI int fmi3SetFloat64(
    Instance *one, const uint32_t *references, size_t count, const double *values)
{
    for (size_t k = 0; k < count; k++) {
        const int r = (int)references[k], p = r - FIRST_PARAMETER;
        if (r >= 1 && r <= STATES) {
            one->values[r - 1] = values[k];
            one->is_changed = true;
        } else if (p >= 0 && p < PARAMETERS) {
            one->params[p] = values[k];
        } else {
            return 3;
        }
    }
    return 0;
}

FMI int fmi3SetTime(Instance *one, double t) { one->t = t; return 0; }

FMI int fmi3GetNumberOfEventIndicators(Instance *one, size_t *n)
{
    (void)one;
    *n = EVENTS;
    return 0;
}

FMI int fmi3GetEventIndicators(Instance *one, double *indicators, size_t count)
{
    const uint32_t reference = FIRST_PARAMETER - 1;
    return fmi3GetFloat64(one, &reference, count, indicators);
}

FMI int fmi3GetNumberOfContinuousStates(Instance *one, size_t *n)
{
    (void)one;
    *n = STATES;
    return 0;
}

FMI int fmi3SetContinuousStates(Instance *one, const double *states, size_t count)
{
    memcpy(one->values, states, count*sizeof(double));
    one->is_changed = true;
    return 0;
}

FMI int fmi3GetContinuousStates(Instance *one, double *states, size_t count)
{
    memcpy(states, one->values, count*sizeof(double));
    return 0;
}

FMI int fmi3GetNominalsOfContinuousStates(Instance *one, double *nominals, size_t count)
{
    (void)one;
    for (size_t k = 0; k < count; k++) {
        nominals[k] = 1.0;
    }
    return 0;
}

FMI int fmi3GetContinuousStateDerivatives(Instance *one, double *derivatives, size_t count)
{
    uint32_t references[STATES];
    for (uint32_t k = 0; k < STATES; k++) {
        references[k] = FIRST_DERIVATIVE + k;
    }
    return fmi3GetFloat64(one, references, count, derivatives);
}

FMI int fmi3CompletedIntegratorStep(Instance *one, bool is_final, bool *enters, bool *ends)
{
    (void)one;
    (void)is_final;
    *enters = *ends = false;
    return 0;
}

FMI int fmi3UpdateDiscreteStates(
    Instance *one, bool *again, bool *ends, bool *nominals, bool *states, bool *is_next, double *t)
{
    (void)one;
    (void)t;
    *again = *ends = *nominals = *states = *is_next = false;
    return 0;
}

static void advance_to(Instance *one, double stop)
{
    const double first = one->h > 0.0 ? one->h : 0.01*(stop - one->t);
    one->h = advance(one->t, stop, first, one->y, ANGLES_OF(one) one->params);
    one->t = stop;
}

FMI int fmi3DoStep(
    Instance *one, double t, double size, bool keeps, bool *event, bool *ends, bool *early,
    double *last)
{
    (void)keeps;
    if (one->is_changed) {
        follow_values(one);
    }
    one->t = t;
    const Instance start = *one;
    first_event = INFINITY;
    earliest_event = one->last_event == t ? t + SEPARATION*size : t;
    advance_to(one, t + size);
    *event = one->ends_steps_at_events && first_event <= t + size;
    if (*event) {
        *one = start;
        one->last_event = first_event;
        advance_to(one, first_event);
    }
    *early = one->t < t + size;
    *ends = false;
    *last = one->t;
    evaluate(one);
    return one->h > 0.0 ? 0 : 3;
}

FMI int fmi3GetFMUState(Instance *one, void **state)
{
    *state = malloc(sizeof(Instance));
    return *state ? (memcpy(*state, one, sizeof(Instance)), 0) : 3;
}

FMI int fmi3SetFMUState(Instance *one, void *state) { memcpy(one, state, sizeof *one); return 0; }
FMI int fmi3FreeFMUState(Instance *one, void **state)
{
    (void)one;
    free(*state);
    *state = NULL;
    return 0;
}
