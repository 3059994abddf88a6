// Numbers of 113 bits, for the few sums and products that doubles are too short for. Computed in software: slow.
#pragma once

#include <cfloat>

namespace hausbench {

#if LDBL_MANT_DIG == 113
using Quad = long double;  // as on 64-bit ARM
#else
__extension__ using Quad = __float128;
#endif

}  // namespace hausbench
