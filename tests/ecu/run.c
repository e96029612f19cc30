/* Takes samples.bin through `bte_run` to answers.bin: on a PC, and on a bare Cortex-M4F, whose
 * files are those of the emulator. figures.bin, uint32, has from there the bytes of the state and
 * of the stack of a step, and the ticks of every step.
 */
#include <stdio.h>

#include "bte.h"

enum { MOST = 5000, PAINTED = 1024 }; /* samples; words of stack below the one who calls a step */
static uint32_t figures[2 + MOST] = {sizeof(bte_state)}, written = 2;

#ifdef __ARM_ARCH_7EM__
#define CPACR (*(volatile uint32_t *)0xE000ED88U)
#define SYSTICK ((volatile uint32_t *)0xE000E010U) /* control, reload, value */
#define FULL 0xFFFFFFU
#define PAINT 0xA5A5A5A5U

__attribute__((noreturn)) void _start(void); /* of the C library: calls main */
void reset(void);
void reset(void) {
    CPACR |= 0xFU << 20; /* the floating point unit is on */
    SYSTICK[1] = FULL;
    SYSTICK[0] = 5U; /* by the clock of the core */
    _start();
}
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))0x20400000U, reset};

__attribute__((noinline)) static bte_reason measured(bte_state *s, const bte_inputs *x) {
    volatile uint32_t *const top = (volatile uint32_t *)__builtin_frame_address(0);
    uint32_t words = PAINTED;
    for (int i = 16; i < PAINTED; i++) {
        top[-i] = PAINT;
    }
    const uint32_t before = SYSTICK[2];
    const bte_reason reason = bte_step(s, x);
    figures[written++] = (before - SYSTICK[2]) & FULL;
    do {
        words--;
    } while (top[-(int)words] == PAINT);
    figures[1] = 4U * words > figures[1] ? 4U * words : figures[1];
    return reason;
}
#define bte_step measured
#endif

#include "bte_run.c"

extern const bte_car bte_car_sedan_2up;

int main(void) {
    static bte_inputs samples[MOST];
    static bte_row rows[MOST];
    FILE *in = fopen("samples.bin", "rb"), *out = fopen("answers.bin", "wb");
    const size_t count = fread(samples, sizeof *samples, MOST, in);
    bte_run(&bte_car_sedan_2up, samples, (uint32_t)count, rows);
    fwrite(rows, sizeof *rows, count, out);
#ifdef SECOND
    extern const bte_car SECOND; /* of another car, with the same code */
    bte_run(&SECOND, samples, (uint32_t)count, rows);
    fwrite(rows, sizeof *rows, count, out);
#endif
    fclose(in);
    fclose(out);
    out = fopen("figures.bin", "wb");
    fwrite(figures, sizeof *figures, written, out);
    return fclose(out);
}
