/* From reset to main on a Cortex-M4F: memory, floating-point unit, and the two calls of semihosting that are used. */
#include "board.h"

extern uint32_t data_load[], data_start[], data_end[], bss_start[], bss_end[], stack_top[];
int main(void);

static void semihosting(int call, const void *argument)
{
    register int r0 __asm__("r0") = call;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

void print(const char *text) { semihosting(0x04, text); } /* SYS_WRITE0 */

void stop(int failed)
{
    semihosting(0x18, (const void *)(failed ? 0x20023 : 0x20026)); /* SYS_EXIT: run-time error, or as it should */
    for (;;) { }
}

void fault(void)
{
    print("fault\n");
    stop(1);
}

void reset(void)
{
    uint32_t *to = data_start;
    const uint32_t *from = data_load;
    *(volatile uint32_t *)0xE000ED88 |= 0xF << 20; /* CPACR: the floating-point unit is on */
    __asm__ volatile("dsb\n isb");
    while (to < data_end) *to++ = *from++;
    for (to = bss_start; to < bss_end; to++) *to = 0;
    stop(main());
}

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    stack_top, (const void *)reset, (const void *)fault, (const void *)fault,
    (const void *)fault, (const void *)fault, (const void *)fault,
};
