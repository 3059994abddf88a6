// Completes the ledger after a run with the time that was saved.
#pragma once

#include "harness/plan/plan.h"
#include "harness/run/finished.h"

#include <vector>

namespace hausbench {

// Adds to the ledger of the plan the time that rows read off others would have taken, and the cost of building
// structures separately for each pose or pair that shared them.
void note_savings(const Plan& plan, const Finished& finished, const std::vector<Row>& rows,
                  std::vector<LedgerEntry>& ledger);

}  // namespace hausbench
