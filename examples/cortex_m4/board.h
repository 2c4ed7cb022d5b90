#include <stdint.h>

void print(const char *text); /* to the terminal of the debugger, or of qemu */
void stop(int failed);
