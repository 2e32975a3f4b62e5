// Properties of the groom store:
//   round trip   what was put comes back whole, also after reopening
//   uniqueness   an id is taken once; a request id makes one groom, from any number of threads
//   paging       every groom once, by id, whatever is put or deleted meanwhile

#include "storage/groom_store.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>
#include <vector>

#include "storage/test_folder.h"

namespace mane::storage {
namespace {

GroomRecord MakeRecord(const std::string& id, const std::string& request_id = "") {
  GroomRecord record;
  record.id = id;
  record.request_id = request_id;
  record.display_name = "Wavy, 'quoted' and ünïcode";
  record.hair_type = 2;
  record.seed = std::numeric_limits<uint64_t>::max() - 1;
  record.guide_count = 200;
  record.element_count = std::numeric_limits<uint32_t>::max();
  record.longest_guide_m = 0.3;
  record.has_scalp = true;
  record.etag = "d1ce" + id;
  record.create_time_ns = 1'700'000'000'123'456'789;
  record.import_summary = std::string("sum\0mary", 8);
  record.contact = std::string("con\0tact", 8);
  record.hair_count = 1'000'000;
  record.hair_point_count = 40'000'000;
  record.hair_offset_unit_m = 1.25e-6;
  return record;
}

class GroomStoreTest : public ::testing::Test {
 protected:
  void SetUp() override { Reopen(); }

  void Reopen() {
    store_.reset();
    auto store = GroomStore::Open(folder_.DatabasePath());
    MANE_ASSERT_OK(store);
    store_ = std::move(*store);
  }

  void Put(const std::string& id) { MANE_ASSERT_OK(store_->Put(MakeRecord(id), {})); }

  TestFolder folder_;
  std::unique_ptr<GroomStore> store_;
  const GroomContent content_{std::string("gro\0om", 6), std::string(3'000'000, '\xee')};
};

TEST_F(GroomStoreTest, GroomComesBackWholeAfterReopening) {
  const GroomRecord record = MakeRecord("demo", "request");
  const auto put = store_->Put(record, content_);
  MANE_ASSERT_OK(put);
  EXPECT_EQ(*put, record);
  for (int i = 0; i < 2; ++i) {
    const auto got = store_->Get("demo");
    MANE_ASSERT_OK(got);
    EXPECT_EQ(*got, record);
    const auto content = store_->GetContent("demo");
    MANE_ASSERT_OK(content);
    EXPECT_EQ(*content, content_);
    Reopen();
  }
}

TEST_F(GroomStoreTest, GroomsFromBeforeImportsContactAndHairsStayAndHaveNone) {
  GroomRecord record = MakeRecord("old");
  MANE_ASSERT_OK(store_->Put(record, content_));
  {
    auto database = Database::Open(folder_.DatabasePath());
    MANE_ASSERT_OK(database);
    MANE_ASSERT_OK(
        database->RunScript("ALTER TABLE grooms DROP COLUMN import_summary;"
                            "ALTER TABLE grooms DROP COLUMN contact;"
                            "ALTER TABLE grooms DROP COLUMN hair_count;"
                            "ALTER TABLE grooms DROP COLUMN hair_point_count;"
                            "ALTER TABLE grooms DROP COLUMN hair_offset_unit_m;"
                            "DELETE FROM schema_migrations WHERE version >= 2;"));
  }
  Reopen();
  record.import_summary.clear();
  record.contact.clear();
  record.hair_count = 0;
  record.hair_point_count = 0;
  record.hair_offset_unit_m = 0;
  const auto got = store_->Get("old");
  MANE_ASSERT_OK(got);
  EXPECT_EQ(*got, record);
}

TEST_F(GroomStoreTest, TakenIdIsRefusedAndTheFirstGroomStays) {
  MANE_ASSERT_OK(store_->Put(MakeRecord("demo", "a"), content_));
  for (const char* request_id : {"", "b"}) {
    const auto again = store_->Put(MakeRecord("demo", request_id), {});
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, ErrorCode::kAlreadyExists);
    EXPECT_EQ(again.error().field, "groom_id");
  }
  const auto content = store_->GetContent("demo");
  MANE_ASSERT_OK(content);
  EXPECT_EQ(*content, content_);
}

TEST_F(GroomStoreTest, EmptyIdIsRefused) {
  const auto put = store_->Put(MakeRecord(""), {});
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().code, ErrorCode::kInvalidArgument);
}

TEST_F(GroomStoreTest, RepeatedRequestReturnsTheFirstGroom) {
  const GroomRecord first = MakeRecord("first", "request");
  MANE_ASSERT_OK(store_->Put(first, content_));
  for (const char* id : {"first", "second"}) {
    const auto again = store_->Put(MakeRecord(id, "request"), {});
    MANE_ASSERT_OK(again);
    EXPECT_EQ(*again, first);
  }
  EXPECT_FALSE(store_->Get("second"));
  const auto content = store_->GetContent("first");
  MANE_ASSERT_OK(content);
  EXPECT_EQ(*content, content_);
}

TEST_F(GroomStoreTest, GroomIsFoundByItsRequest) {
  const GroomRecord record = MakeRecord("demo", "request");
  MANE_ASSERT_OK(store_->Put(record, {}));
  MANE_ASSERT_OK(store_->Put(MakeRecord("without"), {}));
  const auto found = store_->FindByRequestId("request");
  MANE_ASSERT_OK(found);
  EXPECT_EQ(*found, record);
  for (const char* request_id : {"", "other"}) {
    const auto none = store_->FindByRequestId(request_id);
    MANE_ASSERT_OK(none);
    EXPECT_FALSE(none->has_value());
  }
}

// Through two stores on one file, so that the file's lock is tried as well as the mutex.
TEST_F(GroomStoreTest, SimultaneousRequestsMakeOneGroom) {
  auto other = GroomStore::Open(folder_.DatabasePath());
  MANE_ASSERT_OK(other);
  constexpr int kThreads = 4, kRequests = 10;
  std::vector<std::string> answers[kThreads];
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      GroomStore& store = t % 2 == 0 ? *store_ : **other;
      for (int i = 0; i < kRequests; ++i) {
        const auto put = store.Put(
            MakeRecord(fmt::format("groom-{}-{}", i, t), fmt::format("request-{}", i)), {});
        answers[t].push_back(put ? put->id : put.error().message);
      }
    });
  }
  for (auto& thread : threads) thread.join();
  for (const auto& answer : answers) EXPECT_EQ(answer, answers[0]);
  const auto page = store_->List(1000, "");
  MANE_ASSERT_OK(page);
  EXPECT_EQ(page->records.size(), size_t{kRequests});
}

TEST_F(GroomStoreTest, DeletedGroomIsGoneAndItsNamesAreFree) {
  MANE_ASSERT_OK(store_->Put(MakeRecord("demo", "request"), content_));
  MANE_ASSERT_OK(store_->Delete("demo"));
  EXPECT_EQ(store_->Get("demo").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->GetContent("demo").error().code, ErrorCode::kNotFound);
  const auto again = store_->Delete("demo");
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kNotFound);
  EXPECT_NE(again.error().message.find("demo"), std::string::npos);
  MANE_EXPECT_OK(store_->Put(MakeRecord("demo", "request"), {}));
}

TEST_F(GroomStoreTest, PagesHoldEveryGroomOnceById) {
  for (const char* id : {"d", "a", "e", "c", "b"}) Put(id);
  for (int page_size = 1; page_size <= 6; ++page_size) {
    SCOPED_TRACE(page_size);
    std::string ids, token;
    int pages = 0;
    do {
      const auto page = store_->List(page_size, token);
      MANE_ASSERT_OK(page);
      for (const auto& record : page->records) ids += record.id;
      token = page->next_page_token;
      ++pages;
    } while (!token.empty());
    EXPECT_EQ(ids, "abcde");
    EXPECT_EQ(pages, (5 + page_size - 1) / page_size);
  }
}

TEST_F(GroomStoreTest, PagingSurvivesChanges) {
  for (const char* id : {"b", "d", "f", "h"}) Put(id);
  auto page = store_->List(2, "");
  MANE_ASSERT_OK(page);
  MANE_ASSERT_OK(store_->Delete("d"));  // The page's last one, whose id is the token.
  Put("a");
  page = store_->List(2, page->next_page_token);
  MANE_ASSERT_OK(page);
  ASSERT_EQ(page->records.size(), 2u);
  EXPECT_EQ(page->records[0].id, "f");
  EXPECT_EQ(page->records[1].id, "h");
  EXPECT_EQ(page->next_page_token, "");
}

TEST_F(GroomStoreTest, PageSizeOutOfRangeIsRefused) {
  for (const int page_size : {-1, 0, kMaxPageSize + 1}) {
    const auto page = store_->List(page_size, "");
    ASSERT_FALSE(page);
    EXPECT_EQ(page.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(page.error().field, "page_size");
    EXPECT_NE(page.error().message.find(std::to_string(page_size)), std::string::npos);
  }
}

// SQLite stores values of at most 1e9 bytes.
TEST_F(GroomStoreTest, DatabaseErrorsAreSaidByFault) {
  auto database = Database::Open(folder_.DatabasePath());
  MANE_ASSERT_OK(database);
  const auto huge = database->Run("SELECT length(zeroblob(1000000001))");
  ASSERT_FALSE(huge);
  EXPECT_EQ(huge.error().code, ErrorCode::kResourceExhausted);
}

}  // namespace
}  // namespace mane::storage
