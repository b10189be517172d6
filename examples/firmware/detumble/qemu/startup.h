/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STARTUP_H
#define STARTUP_H

#include <stdint.h>

/* Where the processor begins. */
void reset(void);

int main(void);

#endif
