#include "algorithms/error.h"
#include "datasets/formats/readers.h"

namespace hausbench::readers {

Soup read_medit(const Input& input) { throw InputError(input.name + ": is not read yet"); }

}  // namespace hausbench::readers
