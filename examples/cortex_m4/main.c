/* Each recorded reading through the controller: a line of the input's bits in hexadecimal, then the ticks of a timer.

Under qemu with -icount shift=6 an instruction takes 64 ns, and a tick of the board's 25 MHz timer 40 ns: 1.6 ticks an
instruction. The first line is a loop of 20,000 instructions, which shows that this holds.
*/
#include "board.h"
#include "law.h"
#include "readings.h" /* PERIODS, READS, INPUTS, PERIOD, readings */

#define TIMER ((volatile uint32_t *)0x40000000) /* CMSDK timer 0: control, value, reload */

static law_state state;

static void hexadecimal(uint32_t value)
{
    char text[10];
    int i;
    for (i = 0; i < 8; i++) text[i] = "0123456789abcdef"[value >> (28 - 4 * i) & 15];
    text[8] = ' ';
    text[9] = 0;
    print(text);
}

static uint32_t ticks(void) { return 0xFFFFFFFFu - TIMER[1]; }

static void known_loop(void)
{
    uint32_t count = 10000;
    __asm__ volatile("1: subs %0, #1\n bne 1b" : "+r"(count) : : "cc");
}

int main(void)
{
    uint32_t before, taken;
    int i, k;
    TIMER[2] = TIMER[1] = 0xFFFFFFFFu;
    TIMER[0] = 1;
    before = ticks();
    known_loop();
    hexadecimal(ticks() - before);
    before = ticks();
    hexadecimal(ticks() - before); /* of reading the timer */
    print("\n");
    law_reset(&state);
    for (k = 0; k < PERIODS; k++) {
        union {
            law_real value;
            uint32_t bits;
        } u[INPUTS];
        law_real given[INPUTS];
        before = ticks();
        law_act(&state, k * PERIOD, readings + k * READS, given);
        taken = ticks() - before;
        for (i = 0; i < INPUTS; i++) {
            u[i].value = given[i];
            hexadecimal(u[i].bits);
        }
        hexadecimal(taken);
        print("\n");
    }
    return 0;
}
