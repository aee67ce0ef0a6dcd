/* The order of the next step, by the contraction of Newton's iteration.

   METHODS have decreasing orders. Where the iteration contracts fast, steps of a higher order are
   worth their stages; where it contracts slowly or not at all, a lower order takes longer steps
   (E. Hairer, G. Wanner, Journal of Computational and Applied Mathematics 111 (1999) 93-111). */

/* A contraction up to which the order rises, and from which on it falls. */
static const double FAST = 0.002, SLOW = 0.8;
/* The order rises where the factor of the step size is between these. */
static const double STEADY_FROM = 0.8, STEADY_TO = 1.2;

/* The method of the step from a state. */
static inline const Method *method_of_step(const State *start)
{
    return &METHODS[VARIES_ORDER ? (int)start->order[0] : 0];
}

/* The method of the step that ended there. */
static inline const Method *method_of_last_step(const State *start)
{
    return &METHODS[VARIES_ORDER ? (int)start->last_order[0] : 0];
}

/* Choose a lower order for the step from a state. */
static inline void lower_order(State *start)
{
    start->order[0] = lane_fmin(start->order[0] + 1, METHOD_COUNT - 1);
}

/* Choose the order after an accepted step of this contraction; `factor` changes the step size. In
   each following step a contraction counts by half: after a slow one the order does not rise for
   nine steps. */
static inline void choose_order(const State *start, double contraction, double factor, State *end)
{
    end->order[0] = end->last_order[0] = start->order[0];
    end->contraction[0] = lane_fmax(contraction, start->contraction[0]/2);
    if (end->contraction[0] >= SLOW) {
        lower_order(end);
    } else if (end->contraction[0] <= FAST && STEADY_FROM < factor && factor < STEADY_TO) {
        end->order[0] = lane_fmax(end->order[0] - 1, 0);
    }
}
