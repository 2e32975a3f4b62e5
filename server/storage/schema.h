#pragma once

#include "base/result.h"

namespace mane::storage {

class Database;

/// The schema that this build reads and writes: the number of its last migration.
[[nodiscard]] int SchemaVersion();

/// Fails with kFailedPrecondition unless `database` is empty or was made by Mane.
Result<void> CheckOwner(Database& database);

/// Applies the migrations that `database` lacks, all in one transaction, and records each in the
/// table `schema_migrations`. Two processes may do it at once. kFailedPrecondition for a newer
/// schema, which is left untouched.
Result<void> Migrate(Database& database);

}  // namespace mane::storage
