/* Takes samples.h through the estimator on the target.
 *
 * Written: figures.bin (uint32: bytes of the state and of the stack, samples, ticks of all steps and
 * of the worst one, its number) and answers.bin (as of bte_run).
 */
#include "bte_run.h"
#include "samples.h" /* COUNT, samples */
#include "start.h"

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010U)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014U)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018U)
#define FULL 0xFFFFFFU
#define PAINT 0xA5A5A5A5U

enum { STATE, STACK, STEPS, TICKS, WORST, WORST_AT, FIGURES };

extern uint32_t bss_end;
static bte_state state;
static bte_real answers[COUNT * BTE_OUTPUTS];
static uint32_t figures[FIGURES];

static void write_file(const char *name, uint32_t length, const void *data, uint32_t bytes) {
    const uintptr_t opened[3] = {(uintptr_t)name, 5U /* wb */, length};
    const uint32_t file = semihosting(SYS_OPEN, opened);
    const uintptr_t written[3] = {file, (uintptr_t)data, bytes};
    semihosting(SYS_WRITE, written);
    semihosting(SYS_CLOSE, &file);
}

/* Ticks of one step, those of looking at the clock taken off. */
static uint32_t timed(const bte_sample *sample, bte_output *told) {
    const uint32_t nothing = SYSTICK_VALUE, before = SYSTICK_VALUE;
    bte_step(&state, sample, told);
    const uint32_t after = SYSTICK_VALUE;
    return ((before - after) & FULL) - ((nothing - before) & FULL);
}

__attribute__((noinline)) static void step_all(void) {
    for (uint32_t i = 0; i < COUNT; i++) {
        const bte_sample sample = bte_sample_of(&samples[i * BTE_INPUTS]);
        bte_output told;
        const uint32_t ticks = timed(&sample, &told);
        figures[TICKS] += ticks;
        if (ticks > figures[WORST]) {
            figures[WORST] = ticks;
            figures[WORST_AT] = i;
        }
    }
}

/* Bytes below the caller that the steps wrote to. */
__attribute__((noinline)) static uint32_t painted(void) {
    volatile uint32_t *const top = (volatile uint32_t *)__builtin_frame_address(0);
    volatile uint32_t *low = &bss_end;
    for (volatile uint32_t *at = low; at < top - 16; at++) {
        *at = PAINT;
    }
    step_all();
    while (*low == PAINT) {
        low++;
    }
    return (uint32_t)((uintptr_t)top - (uintptr_t)low);
}

int main(void) {
    SYSTICK_RELOAD = FULL;
    SYSTICK_VALUE = 0U;
    SYSTICK_CONTROL = 5U; /* on, by the clock of the core */
    bte_init(&state, &bte_this_car);
    figures[STATE] = sizeof state;
    figures[STEPS] = COUNT;
    figures[STACK] = painted();
    bte_run(samples, COUNT, answers);
    write_file("figures.bin", 11U, figures, sizeof figures);
    write_file("answers.bin", 11U, answers, sizeof answers);
    return 0;
}
