// The cache of fields: by content, bounded, built once however many ask.

#include "contact/field_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "contact/test_meshes.h"

namespace mane::contact {
namespace {

class FieldCacheTest : public ::testing::Test {
 protected:
  FieldCacheTest() { options_.tolerance = 3e-3; }
  std::shared_ptr<const MeshField> Get(FieldCache* cache, const TriangleMesh& mesh) {
    auto field = cache->Get(mesh);
    EXPECT_TRUE(field);
    return field ? *field : nullptr;
  }
  exec::WorkerPool pool_{2};  // Of those who ask; the cache has its own.
  FieldOptions options_;
  const TriangleMesh one_ = fixtures::Sphere(2, 0.1), two_ = fixtures::Sphere(2, 0.11);
};

TEST_F(FieldCacheTest, EqualMeshesShareAField) {
  FieldCache cache(options_, size_t{1} << 30, 2);
  const auto first = Get(&cache, one_);
  EXPECT_EQ(Get(&cache, TriangleMesh(one_)), first);
  EXPECT_NE(Get(&cache, two_), first);
  EXPECT_EQ(cache.size(), 2U);
  EXPECT_EQ(cache.bytes(), first->bytes() + Get(&cache, two_)->bytes());
  TriangleMesh moved = one_;
  moved.vertices[5].x() += 1e-3F;
  EXPECT_NE(Get(&cache, moved), first);
  TriangleMesh turned = one_;
  std::swap(turned.triangles[0], turned.triangles[1]);
  EXPECT_NE(Get(&cache, turned), first);
}

TEST_F(FieldCacheTest, WhatWasUsedLongestAgoGoes) {
  const size_t bytes = (*MeshField::Build(one_, options_, &pool_))->bytes();
  FieldCache cache(options_, 5 * bytes / 2, 2);
  const auto first = Get(&cache, one_);
  const auto second = Get(&cache, two_);
  EXPECT_EQ(Get(&cache, one_), first);
  Get(&cache, fixtures::Sphere(2, 0.105));
  EXPECT_LE(cache.bytes(), 5 * bytes / 2);
  EXPECT_EQ(Get(&cache, one_), first);
  EXPECT_NE(Get(&cache, two_), second);  // The old one lives on with its holder.
  EXPECT_GT(second->bytes(), 0U);
}

TEST_F(FieldCacheTest, WhatIsLargerThanTheCacheIsNotKept) {
  FieldCache cache(options_, 1000, 2);
  EXPECT_NE(Get(&cache, one_), nullptr);
  EXPECT_EQ(cache.size(), 0U);
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST_F(FieldCacheTest, RefusedMeshesAreNotKept) {
  FieldCache cache(options_, size_t{1} << 30, 2);
  EXPECT_FALSE(cache.Get({}));
  EXPECT_EQ(cache.size(), 0U);
}

// Tasks of a pool and other threads, more than either has places for.
TEST_F(FieldCacheTest, ManyWhoAskAtOnceGetTheSame) {
  FieldCache cache(options_, size_t{1} << 30, 2);
  std::vector<std::shared_ptr<const MeshField>> got(8);
  for (auto& field : got) {
    pool_.Post([&cache, &field, this] { field = *cache.Get(one_); });
  }
  std::vector<std::shared_ptr<const MeshField>> more(4);
  std::vector<std::thread> threads;
  for (auto& field : more) {
    threads.emplace_back([&cache, &field, this] { field = *cache.Get(one_); });
  }
  for (std::thread& thread : threads) thread.join();
  pool_.WaitIdle();
  for (const auto& field : got) EXPECT_EQ(field, got[0]);
  for (const auto& field : more) EXPECT_EQ(field, got[0]);
  EXPECT_EQ(cache.size(), 1U);
}

TEST_F(FieldCacheTest, ABuildStopsOnlyWhenAllHaveLeft) {
  FieldCache cache({}, size_t{1} << 30, 2);
  const TriangleMesh heap = fixtures::Heap(1000, 0.05);  // Takes minutes.
  std::atomic<bool> first = false, second = false;
  std::atomic<int> first_asked = 0, second_asked = 0;
  ErrorCode of_first{}, of_second{};
  std::jthread one([&] {
    const auto leaves = [&] {
      ++first_asked;
      return first.load();
    };
    of_first = cache.Get(heap, leaves).error().code;
  });
  while (first_asked == 0) std::this_thread::yield();  // It builds.
  std::jthread two([&] {
    const auto leaves = [&] {
      ++second_asked;
      return second.load();
    };
    of_second = cache.Get(heap, leaves).error().code;
  });
  while (second_asked == 0) std::this_thread::yield();
  first = true;
  // The build goes on and asks the one who is left.
  for (const int asked = second_asked; second_asked < asked + 10;) std::this_thread::yield();
  EXPECT_EQ(cache.size(), 1U);
  second = true;
  one.join(), two.join();
  EXPECT_EQ(of_first, ErrorCode::kCancelled);
  EXPECT_EQ(of_second, ErrorCode::kCancelled);
  EXPECT_EQ(cache.size(), 0U);
  EXPECT_NE(Get(&cache, one_), nullptr);  // Others are served as ever.
}

}  // namespace
}  // namespace mane::contact
