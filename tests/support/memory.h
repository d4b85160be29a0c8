/* How much memory the process holds. */
#ifndef DEASIM_TEST_MEMORY_H
#define DEASIM_TEST_MEMORY_H

/* Bytes of memory in use; aborts where the system does not tell. */
long resident_bytes(void);

#endif
