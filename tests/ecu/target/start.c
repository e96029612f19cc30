/* What a bare Cortex-M4F needs before main, and semihosting: QEMU, or a debugger, does the calls. */
#include "start.h"

#define CPACR (*(volatile uint32_t *)0xE000ED88U)
#define FPU_ON (0xFU << 20)

extern uint32_t stack_top, data_start, data_end, data_in_flash, bss_start, bss_end;
int main(void);
void reset(void);

uint32_t semihosting(uint32_t call, const void *arguments) {
    register uint32_t r0 __asm__("r0") = call;
    register const void *r1 __asm__("r1") = arguments;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

__attribute__((noreturn)) static void leave(uint32_t why) {
    semihosting(SYS_EXIT, (const void *)(uintptr_t)why);
    for (;;) {
    }
}

static void fault(void) { leave(0x20023U); } /* a run-time error: QEMU ends with 1 */

__attribute__((noreturn)) void reset(void) {
    const uint32_t *from = &data_in_flash;
    CPACR |= FPU_ON;
    __asm__ volatile("dsb\n isb");
    for (uint32_t *to = &data_start; to < &data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = &bss_start; to < &bss_end; to++) {
        *to = 0U;
    }
    leave(main() == 0 ? 0x20026U : 0x20023U);
}

typedef struct {
    const uint32_t *stack;
    void (*handler[6])(void); /* reset, NMI, and the faults */
} table_of_vectors;

__attribute__((section(".vectors"), used)) static const table_of_vectors vectors = {
    &stack_top, {reset, fault, fault, fault, fault, fault}};
