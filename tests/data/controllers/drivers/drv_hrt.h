#pragma once
#include <stdint.h>
typedef uint64_t hrt_abstime;
hrt_abstime hrt_absolute_time(void);
hrt_abstime hrt_elapsed_time(const hrt_abstime* then);
