#ifndef START_H
#define START_H

#include <stdint.h>

enum { SYS_OPEN = 0x01, SYS_CLOSE = 0x02, SYS_WRITE = 0x05, SYS_EXIT = 0x18 };

/* One call of the host; what it returns depends on the call. */
uint32_t semihosting(uint32_t call, const void *arguments);

#endif
