// Completes the *ledger*, the list of work that was left out (LedgerEntry), with the seconds that were saved.
#pragma once

#include "harness/plan/plan.h"
#include "harness/run/finished.h"

#include <vector>

namespace hausbench {

// Adds to the ledger of a finished run how much time was saved by reading rows off the runs of other rows, and by
// building structures once for all poses or pairs that use them.
void note_savings(const Plan& plan, const Finished& finished, const std::vector<Row>& rows,
                  std::vector<LedgerEntry>& ledger);

}  // namespace hausbench
