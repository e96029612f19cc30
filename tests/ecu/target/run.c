/* Takes samples.bin through the estimator to answers.bin, rows as of bte_run; on a PC, and on a
 * bare Cortex-M4F, whose files are those of the emulator.
 *
 * There it also writes figures.bin, uint32: bytes of the state and of the stack of a step, samples,
 * ticks of all steps and of the worst one.
 */
#include <stdio.h>

#include "bte.h"

static bte_state state;
static uint32_t figures[5] = {sizeof(bte_state)};

#ifdef __ARM_ARCH_7EM__
#define CPACR (*(volatile uint32_t *)0xE000ED88U)
#define SYSTICK ((volatile uint32_t *)0xE000E010U) /* control, reload, value */
#define FULL 0xFFFFFFU
#define PAINT 0xA5A5A5A5U
enum { PAINTED = 1024 }; /* words below the one who calls a step */

void _start(void); /* of the C library: clears .bss, calls main */
__attribute__((noreturn)) void reset(void);
void reset(void) {
    CPACR |= 0xFU << 20; /* the floating point unit is on */
    SYSTICK[1] = FULL;
    SYSTICK[0] = 5U; /* by the clock of the core */
    _start();
    for (;;) {
    }
}
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))0x20400000U, reset};

/* A step, with its time and its stack. */
__attribute__((noinline)) static bte_reason step(const bte_real x[BTE_INPUTS],
                                                 bte_real y[BTE_ANSWERS][BTE_BOUNDS]) {
    volatile uint32_t *const top = (volatile uint32_t *)__builtin_frame_address(0), *low = top;
    for (int i = 16; i < PAINTED; i++) {
        top[-i] = PAINT;
    }
    const uint32_t nothing = SYSTICK[2], before = SYSTICK[2];
    const bte_reason reason = bte_step(&state, x, y);
    const uint32_t after = SYSTICK[2];
    const uint32_t ticks = ((before - after) & FULL) - ((nothing - before) & FULL);
    for (low -= PAINTED - 1; *low == PAINT; low++) {
    }
    const uint32_t stack = (uint32_t)((uintptr_t)top - (uintptr_t)low);
    figures[1] = stack > figures[1] ? stack : figures[1];
    figures[2]++;
    figures[3] += ticks;
    figures[4] = ticks > figures[4] ? ticks : figures[4];
    return reason;
}
#else
#define step(x, y) bte_step(&state, x, y)
#endif

int main(void) {
    FILE *samples = fopen("samples.bin", "rb"), *answers = fopen("answers.bin", "wb");
    bte_real x[BTE_INPUTS], y[BTE_ANSWERS][BTE_BOUNDS];
    bte_init(&state, &bte_this_car);
    while (fread(x, sizeof x, 1U, samples) == 1U) {
        const bte_real reason = (bte_real)step(x, y);
        fwrite(&reason, sizeof reason, 1U, answers);
        fwrite(y, sizeof y, 1U, answers);
    }
    fclose(answers);
    FILE *told = fopen("figures.bin", "wb");
    fwrite(figures, sizeof figures, 1U, told);
    return fclose(told);
}
